// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

namespace spm::servo {

/// A usage: its page in the upper 16 bits, its number in the lower.
using HidUsage = std::uint32_t;

[[nodiscard]] constexpr HidUsage hid_usage(std::uint16_t page, std::uint16_t number) noexcept {
  return HidUsage{page} << 16U | number;
}

enum class HidReportType : std::uint8_t { input, output, feature };

/// One value of a report, as its descriptor describes it.
struct HidField {
  HidReportType type = HidReportType::input;
  std::uint8_t report_id = 0;  ///< 0: its report has none
  std::uint32_t bit = 0;       ///< where the value begins, after the report id
  std::uint8_t bits = 0;       ///< 1 to 32
  /// its value selects one of the usages; otherwise it is the value of the first usage
  bool is_array = false;
  std::vector<HidUsage> usages;
  std::int64_t logical_min = 0, logical_max = 0;
  std::int64_t physical_min = 0, physical_max = 0;  ///< both 0: same as the logical ones
  std::int32_t unit_exponent = 0;                   ///< power of 10
  std::uint32_t unit = 0;                           ///< as the item encodes it; 0: none
  int collection = -1;                              ///< index of the innermost one; -1: none
};

struct HidCollection {
  HidUsage usage = 0;  ///< 0: it has none
  int parent = -1;     ///< index of the enclosing one; -1: none
};

/// One report, including what its descriptor does not name.
struct HidReport {
  HidReportType type = HidReportType::input;
  std::uint8_t id = 0;
  std::uint32_t bits = 0;  ///< without the report id

  [[nodiscard]] std::size_t bytes() const noexcept { return (std::size_t{bits} + 7) / 8; }
};

/// The contents of a report descriptor. Constants, values without a usage, and values of more than
/// 32 bits are left out of `fields`, but their space is counted.
struct HidDescriptor {
  std::vector<HidField> fields;
  std::vector<HidCollection> collections;
  std::vector<HidReport> reports;
  bool has_ids = false;  ///< reports begin with their id

  /// Whether a field lies in a collection of this usage, at any depth.
  [[nodiscard]] bool is_within(const HidField& field, HidUsage usage) const noexcept;
};

/// The largest descriptor that is accepted. The first limit is the kernel's own; the others are far
/// above what devices have.
inline constexpr std::size_t max_descriptor_bytes = 4096;
inline constexpr std::size_t max_descriptor_fields = 8192;
inline constexpr std::uint32_t max_report_bits = 32768;
/// the remaining usages of an array are left out
inline constexpr std::size_t max_array_usages = 256;
inline constexpr std::size_t max_collection_depth = 32;
inline constexpr std::size_t max_pushes = 16;

enum class HidFault : std::uint8_t {
  too_long,
  cut_short,         ///< the last item says that it is longer than the rest
  bad_report_id,     ///< 0, or above 255
  report_too_long,   ///< the sum of its fields
  too_many_fields,   ///< the sum over all reports
  nested_too_deep,   ///< collections
  not_nested,        ///< a collection ends that never began, or never ends
  pushed_too_often,  ///< without a pop
  popped_too_often,  ///< without a push
};

/// Why a descriptor cannot be used.
struct HidDescriptorError {
  HidFault fault = HidFault::cut_short;
  std::size_t at = 0;  ///< byte offset of the item, or the length if the end is wrong
};

/// As text such as "byte 12: ..." for messages.
[[nodiscard]] std::string to_string(const HidDescriptorError& error);

/// Reads a report descriptor (Device Class Definition for HID 1.11, sections 6.2.2 and 8.4). Long
/// and reserved items are skipped; of delimited usages the first one counts. Pure: any bytes give a
/// descriptor or an error.
[[nodiscard]] tl::expected<HidDescriptor, HidDescriptorError> parse_hid_descriptor(
    std::span<const std::uint8_t> bytes);

}  // namespace spm::servo
