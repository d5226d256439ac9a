// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/vector.hpp"

namespace spm {

/// Checked access to the fields of one JSON object. The first error is kept in `problem`, which an
/// object and its children share, as a clause ("`band.margin` is not a number from 0 to 1"). After
/// that every access gives a harmless value, so that a caller needs only one check, at the end.
class JsonFields {
 public:
  using Json = nlohmann::ordered_json;
  /// Bounds of every number that no narrower ones are given for, in SI units: beyond all that is
  /// meant, and its cube is still a float.
  static constexpr double greatest = 1e12;

  JsonFields(const Json& object, std::string place, std::string& problem);

  [[nodiscard]] double number(const char* key, double low = -greatest, double high = greatest);
  [[nodiscard]] std::uint64_t integer(const char* key, std::uint64_t low, std::uint64_t high);
  [[nodiscard]] bool flag(const char* key);
  [[nodiscard]] std::string text(const char* key);
  /// Three numbers up to `greatest`.
  [[nodiscard]] Vector3 vector(const char* key);
  [[nodiscard]] JsonFields child(const char* key);
  /// An array of integers of exactly three elements, each from `low` to `high`.
  [[nodiscard]] std::array<std::uint32_t, 3> triple(const char* key, std::uint32_t low,
                                                    std::uint32_t high);
  /// The value of a key, or a null value when it is missing, which is no error.
  [[nodiscard]] const Json& optional(const char* key) const;
  /// The array of a key, or an empty array when there is none, which is an error.
  [[nodiscard]] const Json& array(const char* key);

  /// Records that `key` is not what it must be, unless there was an error before.
  void wrong(const char* key, const std::string& wanted);

 private:
  const Json& find(const char* key) const;

  const Json* object_;
  std::string place_;
  std::string* problem_;
};

}  // namespace spm
