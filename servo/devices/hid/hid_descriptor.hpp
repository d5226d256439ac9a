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

/// One value of a report, as its descriptor tells it.
struct HidField {
  HidReportType type = HidReportType::input;
  std::uint8_t report_id = 0;  ///< 0: its report has none
  std::uint32_t bit = 0;       ///< where it begins, after the report id
  std::uint8_t bits = 0;       ///< 1 to 32
  bool is_array = false;       ///< its value picks one of the usages; else it is that of the first
  std::vector<HidUsage> usages;
  std::int64_t logical_min = 0, logical_max = 0;
  std::int64_t physical_min = 0, physical_max = 0;  ///< both 0: as the logical ones
  std::int32_t unit_exponent = 0;                   ///< of 10
  std::uint32_t unit = 0;                           ///< as the item codes it; 0: none
  int collection = -1;                              ///< index of the innermost one; -1: none
};

struct HidCollection {
  HidUsage usage = 0;  ///< 0: it has none
  int parent = -1;     ///< index of the one about it; -1: none
};

/// One report, with what its descriptor does not name included.
struct HidReport {
  HidReportType type = HidReportType::input;
  std::uint8_t id = 0;
  std::uint32_t bits = 0;  ///< without the report id

  [[nodiscard]] std::size_t bytes() const noexcept { return (std::size_t{bits} + 7) / 8; }
};

/// What a report descriptor says. Left out of `fields` are constants, values without a usage, and
/// values of more than 32 bits; their room is counted.
struct HidDescriptor {
  std::vector<HidField> fields;
  std::vector<HidCollection> collections;
  std::vector<HidReport> reports;
  bool has_ids = false;  ///< reports begin with their id

  /// Whether a field lies in a collection of this usage, at any depth.
  [[nodiscard]] bool is_within(const HidField& field, HidUsage usage) const noexcept;
};

/// What a descriptor may be at most. The first is the kernel's own limit; the others are far above
/// what devices have.
inline constexpr std::size_t most_descriptor_bytes = 4096;
inline constexpr std::size_t most_descriptor_fields = 8192;
inline constexpr std::uint32_t most_report_bits = 32768;
inline constexpr std::size_t most_array_usages = 256;  ///< the rest of an array's is left out
inline constexpr std::size_t most_collection_depth = 32;
inline constexpr std::size_t most_pushes = 16;

enum class HidFault : std::uint8_t {
  too_long,
  cut_short,         ///< the last item says that it is longer
  bad_report_id,     ///< 0, or above 255
  report_too_long,   ///< its fields together
  too_many_fields,   ///< of all reports
  nested_too_deep,   ///< collections
  not_nested,        ///< a collection that ends and never began, or the other way round
  pushed_too_often,  ///< without a pop
  popped_too_often,  ///< without a push
};

/// Why a descriptor cannot be used.
struct HidDescriptorError {
  HidFault fault = HidFault::cut_short;
  std::size_t at = 0;  ///< byte of the item, or the length where the end is wrong
};

/// "byte 12: ..." for messages.
[[nodiscard]] std::string to_string(const HidDescriptorError& error);

/// Reads a report descriptor (Device Class Definition for HID 1.11, sections 6.2.2 and 8.4). Long
/// items and items that it reserves are stepped over; of delimited usages the first counts. Pure;
/// any bytes give a descriptor or an error.
[[nodiscard]] tl::expected<HidDescriptor, HidDescriptorError> parse_hid_descriptor(
    std::span<const std::uint8_t> bytes);

}  // namespace spm::servo
