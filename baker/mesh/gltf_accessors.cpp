// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/gltf_accessors.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/gltf_compressed.hpp"

namespace spm::baker {
namespace {

constexpr std::uint64_t most_unpacked = std::uint64_t{1} << 30U;  // bytes

std::size_t component_bytes(int type) {
  switch (type) {
    case 5120:  // signed and unsigned bytes
    case 5121:
      return 1;
    case 5122:  // 16 bits
    case 5123:
      return 2;
    case 5125:  // unsigned 32 bits, float
    case 5126:
      return 4;
    default:
      return 0;
  }
}

template <class T>
double integer_at(const char* at, bool normalized) {
  T value{};
  std::memcpy(&value, at, sizeof value);
  if (!normalized) return static_cast<double>(value);
  return std::max(-1.0, static_cast<double>(value) / std::numeric_limits<T>::max());
}

bool is_index(int type) { return type == 5121 || type == 5123 || type == 5125; }

}  // namespace

double GltfValues::at(std::size_t row, std::size_t column) const {
  const char* const place = first + row * stride + column * component_bytes(type);
  switch (type) {
    case 5120:
      return integer_at<std::int8_t>(place, normalized);
    case 5121:
      return integer_at<std::uint8_t>(place, normalized);
    case 5122:
      return integer_at<std::int16_t>(place, normalized);
    case 5123:
      return integer_at<std::uint16_t>(place, normalized);
    case 5125:
      return integer_at<std::uint32_t>(place, normalized);
    default: {
      float value = 0;
      std::memcpy(&value, place, sizeof value);
      return value;
    }
  }
}

void GltfAccessors::refuse(const std::string& cause, const std::string& cure) const {
  throw BakeError(ExitCode::invalid_input, path_ + ": " + cause + "; " + cure);
}

const GltfAccessors::Json& GltfAccessors::list(const char* name) const {
  static const Json none = Json::array();
  const auto found = file_.json.find(name);
  if (found == file_.json.end()) return none;
  if (!found->is_array()) refuse(std::string("'") + name + "' is no list");
  return *found;
}

const GltfAccessors::Json& GltfAccessors::item(const char* name, std::size_t index) const {
  const Json& all = list(name);
  if (index >= all.size() || !all[index].is_object()) {
    refuse(std::string("there is no ") + std::to_string(index) + " in '" + name + "', of " +
           std::to_string(all.size()));
  }
  return all[index];
}

std::uint64_t GltfAccessors::number(const Json& object, const char* key,
                                    std::optional<std::uint64_t> otherwise,
                                    const std::string& where) const {
  const auto found = object.find(key);
  if (found == object.end() && otherwise) return *otherwise;
  if (found == object.end() || !found->is_number_unsigned()) {
    refuse(where + ": '" + key + "' is " +
           (found == object.end() ? "missing" : "no whole number from 0"));
  }
  return found->get<std::uint64_t>();
}

std::optional<std::vector<double>> GltfAccessors::numbers(const Json& object, const char* key,
                                                          std::size_t count,
                                                          const std::string& where) const {
  const auto found = object.find(key);
  if (found == object.end()) return {};
  std::vector<double> values;
  if (found->is_array()) {
    for (const Json& value : *found) {
      if (value.is_number()) values.push_back(value.get<double>());
    }
  }
  if (values.size() != count) {
    refuse(where + ": '" + key + "' are not " + std::to_string(count) + " numbers");
  }
  return values;
}

const GltfAccessors::Json* GltfAccessors::extension(const Json& object, const char* name) const {
  const auto all = object.find("extensions");
  if (all == object.end() || !all->is_object()) return nullptr;
  const auto found = all->find(name);
  return found != all->end() && found->is_object() ? &*found : nullptr;
}

/// The bytes that a view names, as its buffer has them.
std::string_view GltfAccessors::range(const Json& view, const std::string& place) const {
  const std::uint64_t buffer = number(view, "buffer", {}, place);
  if (buffer >= file_.buffers.size()) {
    refuse(place + ": there is no buffer " + std::to_string(buffer));
  }
  const std::string_view bytes = file_.buffers[buffer];
  const std::uint64_t start = number(view, "byteOffset", 0, place),
                      length = number(view, "byteLength", {}, place);
  if (start > bytes.size() || length > bytes.size() - start) {
    refuse(place + ": " + std::to_string(length) + " bytes from byte " + std::to_string(start) +
           " are more than buffer " + std::to_string(buffer) + " has");
  }
  return bytes.substr(start, length);
}

std::string GltfAccessors::unpacked(const Json& packed, const std::string& place) {
  const auto text = [&](const char* key) {
    const auto found = packed.find(key);
    return found != packed.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  std::optional<std::string> bytes =
      unpack_meshopt({.packed = range(packed, place),
                      .count = number(packed, "count", {}, place),
                      .stride = number(packed, "byteStride", {}, place),
                      .mode = text("mode"),
                      .filter = text("filter")});
  if (!bytes) refuse(place + ": what EXT_meshopt_compression has packed is broken");
  unpacked_bytes_ += bytes->size();
  // Many views may name the same few bytes.
  if (unpacked_bytes_ > most_unpacked) {
    refuse(place + ": with it more than " + std::to_string(most_unpacked) +
               " bytes are unpacked, which cannot be baked",
           "export a coarser mesh");
  }
  return std::move(*bytes);
}

std::string_view GltfAccessors::view_bytes(std::size_t index, const std::string& place) {
  const Json& view = item("bufferViews", index);
  const Json* const packed = extension(view, "EXT_meshopt_compression");
  if (packed == nullptr) return range(view, place);
  const auto known = unpacked_.find(index);
  if (known != unpacked_.end()) return known->second;
  const std::string where = place + ", bufferView " + std::to_string(index);
  return unpacked_.emplace(index, unpacked(*packed, where)).first->second;
}

/// Finds where the values of an accessor, or of its sparse part, begin.
void GltfAccessors::find_values(const Json& object, const std::string& place, GltfValues& values) {
  const std::size_t size = component_bytes(values.type) * values.width;
  const std::size_t index = number(object, "bufferView", {}, place);
  const std::string_view bytes = view_bytes(index, place);
  const Json& view = item("bufferViews", index);
  values.stride = number(view, "byteStride", size, place);
  const std::uint64_t offset = number(object, "byteOffset", 0, place);
  if (values.stride < size || offset > bytes.size() ||
      (values.count > 0 && (bytes.size() - offset < size ||
                            (bytes.size() - offset - size) / values.stride < values.count - 1))) {
    refuse(place + ": " + std::to_string(values.count) + " values are more than buffer " +
           std::to_string(number(view, "buffer", {}, place)) + " has");
  }
  values.first = bytes.data() + offset;
}

/// Copies the values and replaces those that the sparse part names; values of no buffer are 0.
void GltfAccessors::add_sparse(const Json& sparse, const std::string& place, GltfValues& values) {
  const std::size_t size = component_bytes(values.type) * values.width;
  const auto part = [&](const char* key) -> const Json& {
    const auto found = sparse.find(key);
    if (found == sparse.end() || !found->is_object()) {
      refuse(place + ": the '" + std::string(key) + "' of 'sparse' are missing");
    }
    return *found;
  };
  GltfValues indices, replaced = values;
  indices.count = replaced.count = number(sparse, "count", {}, place);
  indices.width = 1;
  indices.type = static_cast<int>(number(part("indices"), "componentType", {}, place));
  if (!is_index(indices.type)) refuse(place + ": the 'indices' of 'sparse' are no indices");
  find_values(part("indices"), place, indices);
  find_values(part("values"), place, replaced);
  std::string bytes(values.count * size, '\0');
  for (std::size_t i = 0; values.first != nullptr && i < values.count; ++i) {
    std::memcpy(bytes.data() + i * size, values.first + i * values.stride, size);
  }
  for (std::size_t i = 0; i < indices.count; ++i) {
    const auto index = static_cast<std::size_t>(indices.at(i, 0));
    if (index >= values.count) {
      refuse(place + ": index " + std::to_string(index) + " of 'sparse' is out of range (" +
             std::to_string(values.count) + " values)");
    }
    std::memcpy(bytes.data() + index * size, replaced.first + i * replaced.stride, size);
  }
  values.own = std::make_shared<const std::string>(std::move(bytes));
  values.first = values.own->data();
  values.stride = size;
}

GltfValues GltfAccessors::values_of(std::size_t index, std::size_t width, const std::string& where,
                                    bool counted) {
  const Json& accessor = item("accessors", index);
  const std::string place = where + ", accessor " + std::to_string(index);
  const auto type = accessor.find("type");
  if (type == accessor.end() || *type != (width == 1 ? "SCALAR" : "VEC" + std::to_string(width))) {
    refuse(place + " is of another type");
  }
  GltfValues values;
  values.count = number(accessor, "count", {}, place);
  values.width = width;
  values.type = static_cast<int>(number(accessor, "componentType", {}, place));
  const auto normalized = accessor.find("normalized");
  values.normalized = normalized != accessor.end() && *normalized == true;
  if (component_bytes(values.type) == 0 || (width == 1 && !is_index(values.type))) {
    refuse(place + ": component type " + std::to_string(values.type) + " is none of its kind");
  }
  const auto sparse = accessor.find("sparse");
  const bool has_sparse = sparse != accessor.end() && sparse->is_object();
  if (accessor.contains("bufferView")) {
    find_values(accessor, place, values);
  } else if (!has_sparse) {
    refuse(place + " has no values: neither 'bufferView' nor 'sparse' names any");
  }
  if (has_sparse && !counted) add_sparse(*sparse, place, values);
  return values;
}

}  // namespace spm::baker
