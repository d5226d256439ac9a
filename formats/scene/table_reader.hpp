// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace spm {

/// A word or a text in single quotes, as messages show it.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// Reads one table of a TOML file, key by key. The first error, which may be an unknown key, is
/// kept in `error` with its line, its cause and its remedy; everything read after it is a default.
/// A key that is missing has its default value.
class TableReader {
 public:
  enum class Minimum { zero, above_zero };

  /// `name` is the table's name in messages. Path, table and error must outlive the reader.
  TableReader(const std::string& path, const toml::table& table, std::string name,
              std::initializer_list<const char*> keys, std::optional<Error>& error);

  [[nodiscard]] bool has(const char* key) const { return table_.contains(key); }
  /// Line of the key, or of the table where the key is missing.
  [[nodiscard]] int line(const char* key) const;

  /// Records an error of code invalid_input at the key, if it is the first error.
  void refuse(const char* key, const std::string& cause);

  /// A text that must not be empty; empty where the key is missing.
  [[nodiscard]] std::string text(const char* key, const std::string& example);

  /// Index of the text among the words.
  [[nodiscard]] std::optional<std::size_t> word(const char* key,
                                                std::span<const char* const> words);
  [[nodiscard]] std::optional<std::size_t> word(const char* key,
                                                std::initializer_list<const char*> words) {
    return word(key, std::span(words.begin(), words.size()));
  }

  /// A quantity with its unit, SI. `also`: what else the key may say, as messages end.
  [[nodiscard]] double quantity(const char* key, Quantity kind, const std::string& example,
                                double otherwise, Minimum min = Minimum::above_zero,
                                const std::string& also = {});

  /// A bare number from `min` to `max`.
  [[nodiscard]] double number(const char* key, double min, double max, double otherwise);

  /// A whole number from `min` to `max`.
  [[nodiscard]] std::uint64_t whole(const char* key, std::uint64_t min, std::uint64_t max,
                                    std::uint64_t otherwise);

  /// true or false.
  [[nodiscard]] bool flag(const char* key, bool otherwise);

  /// The node at the key, or null.
  [[nodiscard]] const toml::node* node(const char* key) const { return table_.get(key); }

  /// A reader of the table at the key; nothing where the key is missing, or is no table.
  [[nodiscard]] std::optional<TableReader> table(const char* key, const std::string& example,
                                                 std::initializer_list<const char*> keys);

 private:
  const std::string& path_;
  const toml::table& table_;
  std::string name_;
  std::optional<Error>& error_;

  void refuse_at(const toml::source_region& place, const std::string& cause);
  void unknown(const toml::key& key, const std::vector<std::string>& known);
};

}  // namespace spm
