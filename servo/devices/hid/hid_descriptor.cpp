// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/hid/hid_descriptor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace spm::servo {

namespace {

/// A short item: its kind, and its data as signed and as unsigned.
struct Item {
  unsigned kind = 0, tag = 0;
  std::size_t bytes = 0;
  std::uint32_t value = 0;

  [[nodiscard]] std::int64_t signed_value() const noexcept {
    if (bytes == 1) return static_cast<std::int8_t>(value);
    if (bytes == 2) return static_cast<std::int16_t>(value);
    return static_cast<std::int32_t>(value);
  }
};

/// A limit whose sign is known only with its partner's: an upper limit is signed if the lower one
/// is below 0, as hosts read it.
struct Limit {
  std::int64_t with_sign = 0, without_sign = 0;
};

/// Global items: they stay in force until they are changed.
struct Globals {
  std::uint16_t page = 0;
  std::int64_t logical_min = 0, physical_min = 0;
  Limit logical_max, physical_max;
  std::int32_t unit_exponent = 0;
  std::uint32_t unit = 0, report_size = 0, report_count = 0;
  std::uint8_t report_id = 0;
};

/// A range of usages. Usages without a page get the one that holds at the main item.
struct UsageRange {
  std::uint32_t first = 0, last = 0;
  bool has_page = false;

  [[nodiscard]] std::uint64_t count() const noexcept {
    return last < first ? 1 : std::uint64_t{last} - first + 1;
  }
};

/// Local items: they hold for the next main item.
struct Locals {
  std::vector<UsageRange> usages;
  std::optional<UsageRange> open_range;  ///< a minimum that waits for its maximum
  bool delimited = false;                ///< within alternatives for one usage
  bool delimited_taken = false;          ///< the first of them was taken
};

class Parser {
 public:
  explicit Parser(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  tl::expected<HidDescriptor, HidDescriptorError> parse() {
    if (bytes_.size() > max_descriptor_bytes) return wrong(HidFault::too_long);
    while (at_ < bytes_.size()) {
      Item item;
      std::size_t next = 0;
      if (!read_item(item, next)) return wrong(HidFault::cut_short);
      if (const auto fault = take(item)) return wrong(*fault);
      at_ = next;
    }
    if (open_ >= 0) return wrong(HidFault::not_nested);
    return std::move(result_);
  }

 private:
  static constexpr std::uint8_t long_item = 0xFE;
  static constexpr unsigned main_kind = 0, global_kind = 1, local_kind = 2, reserved_kind = 3;

  [[nodiscard]] tl::unexpected<HidDescriptorError> wrong(HidFault fault) const {
    return tl::make_unexpected(HidDescriptorError{fault, at_});
  }

  /// A long item is returned as a reserved one, which is ignored.
  bool read_item(Item& item, std::size_t& next) const {
    const std::uint8_t prefix = bytes_[at_];
    if (prefix == long_item) {
      if (at_ + 1 >= bytes_.size()) return false;
      item.kind = reserved_kind;
      next = at_ + 3 + bytes_[at_ + 1];
      return next <= bytes_.size();
    }
    item.kind = prefix >> 2U & 3U;
    item.tag = prefix >> 4U;
    item.bytes = (prefix & 3U) == 3 ? 4 : prefix & 3U;
    next = at_ + 1 + item.bytes;
    if (next > bytes_.size()) return false;
    for (std::size_t i = 0; i < item.bytes; ++i) {
      item.value |= std::uint32_t{bytes_[at_ + 1 + i]} << (8 * i);
    }
    return true;
  }

  std::optional<HidFault> take(const Item& item) {
    switch (item.kind) {
      case main_kind: {
        const auto fault = take_main(item);
        locals_ = Locals{};
        return fault;
      }
      case global_kind:
        return take_global(item);
      case local_kind:
        take_local(item);
        return std::nullopt;
      default:
        return std::nullopt;
    }
  }

  std::optional<HidFault> take_main(const Item& item) {
    switch (item.tag) {
      case 0x8:
        return add_fields(HidReportType::input, item.value);
      case 0x9:
        return add_fields(HidReportType::output, item.value);
      case 0xB:
        return add_fields(HidReportType::feature, item.value);
      case 0xA:
        if (depth_ == max_collection_depth) return HidFault::nested_too_deep;
        ++depth_;
        result_.collections.push_back({locals_.usages.empty() ? 0 : usage_at(0), open_});
        open_ = static_cast<int>(result_.collections.size()) - 1;
        return std::nullopt;
      case 0xC:
        if (open_ < 0) return HidFault::not_nested;
        --depth_;
        open_ = result_.collections[static_cast<std::size_t>(open_)].parent;
        return std::nullopt;
      default:
        return std::nullopt;
    }
  }

  std::optional<HidFault> take_global(const Item& item) {
    const Limit limit{item.signed_value(), item.value};
    switch (item.tag) {
      case 0x0:
        globals_.page = static_cast<std::uint16_t>(item.value);
        break;
      case 0x1:
        globals_.logical_min = limit.with_sign;
        break;
      case 0x2:
        globals_.logical_max = limit;
        break;
      case 0x3:
        globals_.physical_min = limit.with_sign;
        break;
      case 0x4:
        globals_.physical_max = limit;
        break;
      case 0x5:
        globals_.unit_exponent = exponent_of(item);
        break;
      case 0x6:
        globals_.unit = item.value;
        break;
      case 0x7:
        globals_.report_size = item.value;
        break;
      case 0x8:
        if (item.value == 0 || item.value > 0xFF) return HidFault::bad_report_id;
        globals_.report_id = static_cast<std::uint8_t>(item.value);
        result_.has_ids = true;
        break;
      case 0x9:
        globals_.report_count = item.value;
        break;
      case 0xA:
        if (pushed_.size() == max_pushes) return HidFault::pushed_too_often;
        pushed_.push_back(globals_);
        break;
      case 0xB:
        if (pushed_.empty()) return HidFault::popped_too_often;
        globals_ = pushed_.back();
        pushed_.pop_back();
        break;
      default:
        break;
    }
    return std::nullopt;
  }

  /// A signed number of four bits, which some devices write as a whole byte.
  static std::int32_t exponent_of(const Item& item) noexcept {
    if (item.value <= 0xF) {
      return item.value < 8 ? static_cast<std::int32_t>(item.value)
                            : static_cast<std::int32_t>(item.value) - 16;
    }
    return static_cast<std::int32_t>(item.signed_value());
  }

  void take_local(const Item& item) {
    const bool has_page = item.bytes == 4;
    switch (item.tag) {
      case 0x0:
        add_usages({item.value, item.value, has_page});
        break;
      case 0x1:
        locals_.open_range = UsageRange{item.value, item.value, has_page};
        break;
      case 0x2:
        if (!locals_.open_range) break;
        locals_.open_range->last = item.value;
        add_usages(*locals_.open_range);
        locals_.open_range.reset();
        break;
      case 0xA:
        locals_.delimited = item.value == 1;
        locals_.delimited_taken = false;
        break;
      default:
        break;
    }
  }

  void add_usages(const UsageRange& range) {
    if (locals_.delimited && locals_.delimited_taken) return;
    locals_.delimited_taken = true;
    locals_.usages.push_back(range);
  }

  /// The usage of the value at an index; the last usage is that of all further values.
  [[nodiscard]] HidUsage usage_at(std::uint64_t place) const noexcept {
    for (const UsageRange& range : locals_.usages) {
      const bool last = &range == &locals_.usages.back();
      if (place >= range.count() && !last) {
        place -= range.count();
        continue;
      }
      const auto step = static_cast<std::uint32_t>(std::min(place, range.count() - 1));
      const std::uint32_t number = range.first + step;
      return range.has_page ? number : hid_usage(globals_.page, static_cast<std::uint16_t>(number));
    }
    return 0;
  }

  /// The report that the next fields belong to.
  HidReport& report_of(HidReportType type) {
    for (HidReport& report : result_.reports) {
      if (report.type == type && report.id == globals_.report_id) return report;
    }
    result_.reports.push_back({type, globals_.report_id, 0});
    return result_.reports.back();
  }

  std::optional<HidFault> add_fields(HidReportType type, std::uint32_t flags) {
    constexpr std::uint32_t constant = 1, variable = 2;
    HidReport& report = report_of(type);
    const std::uint64_t all = std::uint64_t{globals_.report_size} * globals_.report_count;
    if (all > max_report_bits - report.bits) return HidFault::report_too_long;
    std::uint32_t bit = report.bits;
    report.bits += static_cast<std::uint32_t>(all);
    const std::uint32_t size = globals_.report_size;
    if ((flags & constant) != 0 || locals_.usages.empty() || size == 0 || size > 32) {
      return std::nullopt;
    }
    HidField field = field_of(type, (flags & variable) == 0);
    for (std::uint32_t i = 0; i < globals_.report_count; ++i, bit += size) {
      if (result_.fields.size() == max_descriptor_fields) return HidFault::too_many_fields;
      field.bit = bit;
      if (!field.is_array) field.usages.assign(1, usage_at(i));
      result_.fields.push_back(field);
    }
    return std::nullopt;
  }

  /// A field of the next main item, without its position in the report.
  [[nodiscard]] HidField field_of(HidReportType type, bool is_array) const {
    HidField field;
    field.type = type;
    field.report_id = globals_.report_id;
    field.bits = static_cast<std::uint8_t>(globals_.report_size);
    field.is_array = is_array;
    field.logical_min = globals_.logical_min;
    field.logical_max =
        field.logical_min < 0 ? globals_.logical_max.with_sign : globals_.logical_max.without_sign;
    field.physical_min = globals_.physical_min;
    field.physical_max = field.physical_min < 0 ? globals_.physical_max.with_sign
                                                : globals_.physical_max.without_sign;
    field.unit_exponent = globals_.unit_exponent;
    field.unit = globals_.unit;
    field.collection = open_;
    if (!is_array) return field;
    std::uint64_t count = 0;
    for (const UsageRange& range : locals_.usages) count += range.count();
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(count, max_array_usages); ++i) {
      field.usages.push_back(usage_at(i));
    }
    return field;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0, depth_ = 0;
  int open_ = -1;  ///< the innermost collection
  Globals globals_;
  Locals locals_;
  std::vector<Globals> pushed_;
  HidDescriptor result_;
};

const char* reason(HidFault fault) noexcept {
  switch (fault) {
    case HidFault::too_long:
      return "it is longer than a descriptor can be";
    case HidFault::cut_short:
      return "it ends within an item";
    case HidFault::bad_report_id:
      return "a report id is 0 or above 255";
    case HidFault::report_too_long:
      return "a report is longer than reports can be";
    case HidFault::too_many_fields:
      return "it has too many fields";
    case HidFault::nested_too_deep:
      return "its collections are nested too deep";
    case HidFault::not_nested:
      return "its collections do not begin and end in pairs";
    case HidFault::pushed_too_often:
      return "it pushes its state too often";
    case HidFault::popped_too_often:
      return "it pops a state that it did not push";
  }
  return "it makes no sense";
}

}  // namespace

bool HidDescriptor::is_within(const HidField& field, HidUsage usage) const noexcept {
  for (int at = field.collection; at >= 0; at = collections[static_cast<std::size_t>(at)].parent) {
    if (collections[static_cast<std::size_t>(at)].usage == usage) return true;
  }
  return false;
}

std::string to_string(const HidDescriptorError& error) {
  return fmt::format("byte {}: {}", error.at, reason(error.fault));
}

tl::expected<HidDescriptor, HidDescriptorError> parse_hid_descriptor(
    std::span<const std::uint8_t> bytes) {
  return Parser(bytes).parse();
}

}  // namespace spm::servo
