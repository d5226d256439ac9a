// SPDX-License-Identifier: Apache-2.0
#include "formats/files/json_fields.hpp"

#include <array>
#include <cmath>
#include <utility>

namespace spm {
namespace {

const JsonFields::Json null_value;
const JsonFields::Json empty_array = JsonFields::Json::array();

std::string printed(double value) { return JsonFields::Json(value).dump(); }

}  // namespace

JsonFields::JsonFields(const Json& object, std::string place, std::string& problem)
    : object_(&object), place_(std::move(place)), problem_(&problem) {}

const JsonFields::Json& JsonFields::find(const char* key) const {
  if (!problem_->empty() || !object_->is_object()) return null_value;
  const auto found = object_->find(key);
  return found == object_->end() ? null_value : *found;
}

void JsonFields::wrong(const char* key, const std::string& wanted) {
  if (!problem_->empty()) return;
  *problem_ = "`" + place_ + key + "` is not " + wanted;
}

double JsonFields::number(const char* key, double low, double high) {
  const Json& value = find(key);
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (std::isfinite(number) && number >= low && number <= high) return number;
  wrong(key, "a number from " + printed(low) + " to " + printed(high));
  return 0;
}

std::uint64_t JsonFields::integer(const char* key, std::uint64_t low, std::uint64_t high) {
  const Json& value = find(key);
  if (value.is_number_unsigned()) {
    const auto number = value.get<std::uint64_t>();
    if (number >= low && number <= high) return number;
  }
  wrong(key, "an integer from " + std::to_string(low) + " to " + std::to_string(high));
  return low;
}

bool JsonFields::flag(const char* key) {
  const Json& value = find(key);
  if (value.is_boolean()) return value.get<bool>();
  wrong(key, "true or false");
  return false;
}

std::string JsonFields::text(const char* key) {
  const Json& value = find(key);
  if (value.is_string()) return value.get<std::string>();
  wrong(key, "a string");
  return {};
}

Vector3 JsonFields::vector(const char* key) {
  const Json& value = find(key);
  Vector3 vector = Vector3::Zero();
  bool good = value.is_array() && value.size() == 3;
  for (int axis = 0; good && axis < 3; ++axis) {
    const Json& component = value[static_cast<std::size_t>(axis)];
    good = component.is_number() && std::abs(component.get<double>()) <= greatest;
    if (good) vector[axis] = component.get<double>();
  }
  if (!good)
    wrong(key, "an array of three numbers from " + printed(-greatest) + " to " + printed(greatest));
  return good ? vector : Vector3::Zero();
}

JsonFields JsonFields::child(const char* key) {
  const Json& value = find(key);
  if (!value.is_object()) wrong(key, "an object");
  return {value, place_ + key + ".", *problem_};
}

std::array<std::uint32_t, 3> JsonFields::triple(const char* key, std::uint32_t low,
                                                std::uint32_t high) {
  const Json& value = find(key);
  std::array<std::uint32_t, 3> numbers{low, low, low};
  bool good = value.is_array() && value.size() == 3;
  for (std::size_t axis = 0; good && axis < 3; ++axis) {
    const std::uint64_t number =
        value[axis].is_number_unsigned() ? value[axis].get<std::uint64_t>() : std::uint64_t{0};
    good = value[axis].is_number_unsigned() && number >= low && number <= high;
    if (good) numbers[axis] = static_cast<std::uint32_t>(number);
  }
  if (!good) {
    wrong(key,
          "an array of three integers from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return numbers;
}

const JsonFields::Json& JsonFields::optional(const char* key) const { return find(key); }

const JsonFields::Json& JsonFields::array(const char* key) {
  const Json& value = find(key);
  if (value.is_array()) return value;
  wrong(key, "an array");
  return empty_array;
}

}  // namespace spm
