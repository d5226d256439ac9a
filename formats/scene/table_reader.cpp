// SPDX-License-Identifier: Apache-2.0
#include "formats/scene/table_reader.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "formats/files/nearest_word.hpp"

namespace spm {

namespace {

/// A bound as messages show it, with no more digits than needed.
std::string shown(double value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << value;
  return text.str();
}

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string result(1, '\'');
  result.append(text).push_back('\'');
  return result;
}

TableReader::TableReader(const std::string& path, const toml::table& table, std::string name,
                         std::initializer_list<const char*> keys, std::optional<Error>& error)
    : path_(path), table_(table), name_(std::move(name)), error_(error) {
  const std::vector<std::string> known(keys.begin(), keys.end());
  for (const auto& [key, value] : table_) {
    if (std::find(known.begin(), known.end(), key.str()) == known.end()) unknown(key, known);
  }
}

int TableReader::line(const char* key) const {
  const toml::node* value = table_.get(key);
  const toml::source_region& place = value != nullptr ? value->source() : table_.source();
  return static_cast<int>(place.begin.line);
}

void TableReader::refuse(const char* key, const std::string& cause) {
  const toml::node* value = table_.get(key);
  refuse_at(value != nullptr ? value->source() : table_.source(), cause);
}

void TableReader::refuse_at(const toml::source_region& place, const std::string& cause) {
  if (error_) return;
  error_ = Error{ExitCode::invalid_input,
                 path_ + ": line " + std::to_string(place.begin.line) + ": " + cause};
}

void TableReader::unknown(const toml::key& key, const std::vector<std::string>& known) {
  std::string cause = "unknown key " + in_quotes(key.str()) + " in " + name_ + "; ";
  if (const auto near = cli::nearest_word(key.str(), known)) {
    cause += "did you mean " + in_quotes(*near) + "?";
  } else {
    cause += "its keys are";
    for (const std::string& name : known) cause += " " + name;
  }
  refuse_at(key.source(), cause);
}

std::string TableReader::text(const char* key, const std::string& example) {
  const toml::node* value = table_.get(key);
  if (value == nullptr) return {};
  const auto* found = value->as_string();
  if (found != nullptr && !found->get().empty()) return found->get();
  refuse(key, in_quotes(key) + " must be text, such as \"" + example + "\"");
  return {};
}

std::optional<std::size_t> TableReader::word(const char* key, std::span<const char* const> words) {
  const std::string found = text(key, *words.begin());
  if (found.empty()) return std::nullopt;
  const auto at = std::find(words.begin(), words.end(), found);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  std::string cause = in_quotes(key) + " " + in_quotes(found) + " is not known; it can be";
  for (const char* each : words) cause += std::string(" ") + each;
  refuse(key, cause);
  return std::nullopt;
}

double TableReader::quantity(const char* key, Quantity kind, const std::string& example,
                             double otherwise, Minimum min, const std::string& also) {
  const toml::node* value = table_.get(key);
  if (value == nullptr) return otherwise;
  const auto* found = value->as_string();
  if (found == nullptr) {
    refuse(key, in_quotes(key) + " must be text with its unit, such as \"" + example + "\"" + also);
    return otherwise;
  }
  const Result<double> parsed = parse_quantity(found->get(), kind);
  if (!parsed) {
    refuse(key, in_quotes(key) + ": " + parsed.error().message + also);
    return otherwise;
  }
  const bool zero_allowed = min == Minimum::zero;
  if (*parsed > 0 || (zero_allowed && *parsed == 0)) return *parsed;
  refuse(key, in_quotes(key) + (zero_allowed ? " must be 0 or more" : " must be above 0") +
                  ", such as \"" + example + "\"" + also);
  return otherwise;
}

double TableReader::number(const char* key, double min, double max, double otherwise) {
  const toml::node* value = table_.get(key);
  if (value == nullptr) return otherwise;
  const std::optional<double> found = value->value<double>();
  if (value->is_number() && found && *found >= min && *found <= max) return *found;
  refuse(key, in_quotes(key) + " must be a number from " + shown(min) + " to " + shown(max) +
                  ", without a unit");
  return otherwise;
}

std::uint64_t TableReader::whole(const char* key, std::uint64_t min, std::uint64_t max,
                                 std::uint64_t otherwise) {
  const toml::node* value = table_.get(key);
  if (value == nullptr) return otherwise;
  const auto* found = value->as_integer();
  if (found != nullptr && found->get() >= 0) {
    const auto number = static_cast<std::uint64_t>(found->get());
    if (number >= min && number <= max) return number;
  }
  refuse(key, in_quotes(key) + " must be a whole number from " + std::to_string(min) + " to " +
                  std::to_string(max));
  return otherwise;
}

bool TableReader::flag(const char* key, bool otherwise) {
  const toml::node* value = table_.get(key);
  if (value == nullptr) return otherwise;
  if (const auto* found = value->as_boolean()) return found->get();
  refuse(key, in_quotes(key) + " must be true or false, without quotes");
  return otherwise;
}

std::optional<TableReader> TableReader::table(const char* key, const std::string& example,
                                              std::initializer_list<const char*> keys) {
  const toml::node* value = table_.get(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_table()) {
    refuse(key, in_quotes(key) + " must be a table, such as " + example);
    return std::nullopt;
  }
  return TableReader(path_, *value->as_table(), in_quotes(key), keys, error_);
}

}  // namespace spm
