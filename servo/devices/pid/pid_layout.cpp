// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pid/pid_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>

#include "servo/devices/base/device_ids.hpp"

namespace spm::servo {

namespace {

constexpr HidUsage pid(std::uint16_t number) noexcept { return hid_usage(pid_usage_page, number); }

/// Collections and fields of the usage page of force feedback.
namespace usages {
constexpr HidUsage set_effect = pid(0x21);
constexpr HidUsage block_index = pid(0x22);
constexpr HidUsage block_offset = pid(0x23);
constexpr HidUsage type_constant = pid(0x26);
constexpr HidUsage duration = pid(0x50);
constexpr HidUsage effect_gain = pid(0x52);
constexpr HidUsage trigger_button = pid(0x53);
constexpr HidUsage axes_enable = pid(0x55);
constexpr HidUsage direction_enable = pid(0x56);
constexpr HidUsage direction = pid(0x57);
constexpr HidUsage magnitude = pid(0x70);
constexpr HidUsage set_constant_force = pid(0x73);
constexpr HidUsage effect_operation = pid(0x77);
constexpr HidUsage operation_start = pid(0x79);
constexpr HidUsage operation_stop = pid(0x7B);
constexpr HidUsage loop_count = pid(0x7C);
constexpr HidUsage device_gain = pid(0x7E);
constexpr HidUsage block_load = pid(0x89);
constexpr HidUsage load_success = pid(0x8C);
constexpr HidUsage load_full = pid(0x8D);
constexpr HidUsage block_free = pid(0x90);
constexpr HidUsage enable_actuators = pid(0x97);
constexpr HidUsage stop_all_effects = pid(0x99);
constexpr HidUsage device_reset = pid(0x9A);
constexpr HidUsage device_managed = pid(0xA9);
constexpr HidUsage create_new_effect = pid(0xAB);
}  // namespace usages

constexpr std::uint16_t button_page = 0x09;
constexpr std::uint16_t max_buttons = 32;

/// The axes of a hand, on the desktop usage page.
constexpr std::array<HidUsage, 2> axis_usages{hid_usage(0x01, 0x30), hid_usage(0x01, 0x31)};

constexpr HidUsage anywhere = 0;

/// Something that constant force requires.
struct Missing {
  const char* what;
};

/// Finds fields by type of report, collection and usage.
class Finder {
 public:
  explicit Finder(const HidDescriptor& descriptor) : descriptor_(descriptor) {}

  /// A finder for fields of the same report only.
  [[nodiscard]] Finder beside(const HidField& field) const {
    Finder near(*this);
    near.report_ = HidReport{field.type, field.report_id, 0};
    return near;
  }

  using Types = std::initializer_list<HidReportType>;
  static constexpr Types sent{HidReportType::output, HidReportType::feature};

  [[nodiscard]] std::optional<HidField> field(Types types, HidUsage collection,
                                              HidUsage usage) const {
    return first(types, collection, [usage](const HidField& field) {
      return !field.is_array && field.usages.front() == usage;
    });
  }

  /// A usage that an array selects among others, or that is a single bit.
  [[nodiscard]] std::optional<PidChoice> choice(Types types, HidUsage collection,
                                                HidUsage usage) const {
    const auto place_in = [usage](const HidField& field) {
      return std::find(field.usages.begin(), field.usages.end(), usage) - field.usages.begin();
    };
    const auto found = first(types, collection, [&](const HidField& field) {
      return place_in(field) < std::ssize(field.usages);
    });
    if (!found) return std::nullopt;
    // A single bit is set, whatever range it shares with an array beside it.
    return PidChoice{*found, found->is_array ? found->logical_min + place_in(*found) : 1};
  }

  /// The first field of a collection with any usage, or the one that has the collection's usage.
  [[nodiscard]] std::optional<HidField> first_in(HidUsage collection, HidUsage inner) const {
    return first({HidReportType::output}, collection, [&](const HidField& field) {
      const bool is_inner = descriptor_.is_within(field, inner) || field.usages.front() == inner;
      return !field.is_array && is_inner;
    });
  }

  [[nodiscard]] bool has_collection(HidUsage usage) const {
    return std::any_of(descriptor_.collections.begin(), descriptor_.collections.end(),
                       [usage](const HidCollection& known) { return known.usage == usage; });
  }

 private:
  /// Types in their order, and the fields of a type in the descriptor's order.
  template <class Match>
  [[nodiscard]] std::optional<HidField> first(Types types, HidUsage collection,
                                              const Match& matches) const {
    for (const HidReportType type : types) {
      for (const HidField& field : descriptor_.fields) {
        if (fits(field, type, collection) && matches(field)) return field;
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] bool fits(const HidField& field, HidReportType type, HidUsage collection) const {
    if (report_ && (field.type != report_->type || field.report_id != report_->id)) return false;
    return field.type == type &&
           (collection == anywhere || descriptor_.is_within(field, collection));
  }

  const HidDescriptor& descriptor_;
  std::optional<HidReport> report_;  ///< empty: any report
};

/// Takes what was found, or records what was not.
template <class Part>
std::optional<Missing> take(Part& part, const std::optional<Part>& found, const char* what) {
  if (!found) return Missing{what};
  part = *found;
  return std::nullopt;
}

/// The first part that is missing.
std::optional<Missing> first_of(std::initializer_list<std::optional<Missing>> all) {
  for (const auto& missing : all) {
    if (missing) return missing;
  }
  return std::nullopt;
}

std::optional<Missing> find_effect(const Finder& find, PidLayout& layout) {
  const Finder::Types out{HidReportType::output};
  auto& effect = layout.set_effect;
  const auto missing =
      take(effect.constant, find.choice(out, usages::set_effect, usages::type_constant),
           "the effect type constant force (usage 0x26) in a Set Effect report (0x21)");
  if (missing) return missing;
  const Finder near = find.beside(effect.constant.field);
  effect.gain = near.field(out, usages::set_effect, usages::effect_gain);
  effect.trigger_button = near.field(out, usages::set_effect, usages::trigger_button);
  return first_of({take(effect.block, near.field(out, usages::set_effect, usages::block_index),
                        "an effect block index (usage 0x22) in its Set Effect report (0x21)"),
                   take(effect.duration, near.field(out, usages::set_effect, usages::duration),
                        "a duration (usage 0x50) in its Set Effect report (0x21)")});
}

std::optional<Missing> find_force(const Finder& find, PidLayout& layout) {
  const Finder::Types out{HidReportType::output};
  auto& force = layout.constant_force;
  const auto missing =
      take(force.magnitude, find.field(out, usages::set_constant_force, usages::magnitude),
           "a Set Constant Force report (usage 0x73) with a magnitude (0x70)");
  if (missing) return missing;
  if (force.magnitude.logical_min >= 0 || force.magnitude.logical_max <= 0) {
    return Missing{"a sign in the magnitude (usage 0x70) of its Set Constant Force report (0x73)"};
  }
  const Finder near = find.beside(force.magnitude);
  if (near.field(out, usages::set_constant_force, usages::block_offset)) {
    return Missing{
        "effects by an index: it wants the host to manage its memory of effects (usage 0x23), "
        "which is not supported"};
  }
  return take(force.block, near.field(out, usages::set_constant_force, usages::block_index),
              "an effect block index (usage 0x22) in its Set Constant Force report (0x73)");
}

std::optional<Missing> find_operation(const Finder& find, PidLayout& layout) {
  const Finder::Types out{HidReportType::output};
  auto& operation = layout.operation;
  const auto missing =
      take(operation.start, find.choice(out, usages::effect_operation, usages::operation_start),
           "an Effect Operation report (usage 0x77) with the start of an effect (0x79)");
  if (missing) return missing;
  const Finder near = find.beside(operation.start.field);
  operation.loops = near.field(out, usages::effect_operation, usages::loop_count);
  return first_of(
      {take(operation.block, near.field(out, usages::effect_operation, usages::block_index),
            "an effect block index (usage 0x22) in its Effect Operation report (0x77)"),
       take(operation.stop, near.choice(out, usages::effect_operation, usages::operation_stop),
            "the stop of an effect (usage 0x7B) in its Effect Operation report (0x77)")});
}

std::optional<Missing> find_memory(const Finder& find, PidLayout& layout) {
  const Finder::Types feature{HidReportType::feature};
  layout.free_block = find.field(Finder::sent, usages::block_free, usages::block_index);
  layout.device_managed_pool = find.field(feature, anywhere, usages::device_managed);
  const auto missing = first_of(
      {take(layout.create,
            find.choice({HidReportType::feature, HidReportType::output}, usages::create_new_effect,
                        usages::type_constant),
            "the effect type constant force (usage 0x26) in a Create New Effect report (0xAB)"),
       take(layout.load.success, find.choice(feature, usages::block_load, usages::load_success),
            "a Block Load report (usage 0x89) with a status of success (0x8C)")});
  if (missing) return missing;
  const Finder near = find.beside(layout.load.success.field);
  layout.load.full = near.choice(feature, usages::block_load, usages::load_full);
  return take(layout.load.block, near.field(feature, usages::block_load, usages::block_index),
              "an effect block index (usage 0x22) in its Block Load report (0x89)");
}

/// Positions and buttons, which are in input reports. False if there is no X.
bool find_input(const HidDescriptor& descriptor, const Finder& find, PidLayout& layout) {
  const Finder::Types in{HidReportType::input};
  const auto usable = [](const std::optional<HidField>& field) {
    return field && field->logical_min < field->logical_max;
  };
  const auto x = find.field(in, anywhere, axis_usages[0]);
  if (!usable(x)) return false;
  layout.position[0] = *x;
  const auto y = find.field(in, anywhere, axis_usages[1]);
  if (usable(y)) {
    layout.position[1] = *y;
    layout.axes = 2;
  }
  for (std::uint16_t number = 1; number <= max_buttons; ++number) {
    const auto button = find.field(in, anywhere, hid_usage(button_page, number));
    if (!button) break;
    layout.buttons.push_back(*button);
  }
  layout.has_ids = descriptor.has_ids;
  layout.reports = descriptor.reports;
  return true;
}

/// Finds how a direction can be given, and for how many axes. The kernel's own method comes first.
std::optional<Missing> find_directions(const Finder& find, PidLayout& layout,
                                       std::optional<PidDirection> wanted) {
  const Finder::Types out{HidReportType::output};
  auto& effect = layout.set_effect;
  const Finder near = find.beside(effect.block);
  effect.direction_enable = near.field(out, usages::set_effect, usages::direction_enable);
  for (std::size_t axis = 0; axis < axis_usages.size(); ++axis) {
    effect.axis_enable[axis] = near.field(out, usages::axes_enable, axis_usages[axis]);
    effect.direction[axis] = near.field(out, usages::direction, axis_usages[axis]);
  }
  const auto angle = near.first_in(usages::set_effect, usages::direction);
  const bool has_parts = effect.direction[0].has_value();
  // A second axis that is measured but takes no force is no axis of the hand, such as a wheel's
  // pedal.
  const bool second = find.has_collection(usages::axes_enable)
                          ? effect.axis_enable[1].has_value()
                          : (has_parts ? effect.direction[1] : angle).has_value();
  if (!second) layout.axes = 1;
  const auto all = [&layout](const std::array<std::optional<HidField>, 2>& fields) {
    return fields[0] && (layout.axes == 1 || fields[1]);
  };
  const bool cartesian = all(effect.direction);
  const bool polar = angle && (wanted == PidDirection::polar || !has_parts);
  const bool axes = all(effect.axis_enable) || layout.axes == 1;
  effect.direction_form = wanted.value_or(polar       ? PidDirection::polar
                                          : cartesian ? PidDirection::cartesian
                                                      : PidDirection::axes);
  switch (effect.direction_form) {
    case PidDirection::polar:
      if (!polar) return Missing{"a direction (usage 0x57) in its Set Effect report (0x21)"};
      effect.direction = {angle, std::nullopt};
      return std::nullopt;
    case PidDirection::cartesian:
      if (!cartesian) return Missing{"a direction (usage 0x57) with a part for each axis"};
      return std::nullopt;
    case PidDirection::axes:
      if (!axes) return Missing{"a direction (usage 0x57), or axes to enable (0x55)"};
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

const char* to_string(PidDirection direction) noexcept {
  switch (direction) {
    case PidDirection::polar:
      return "polar";
    case PidDirection::cartesian:
      return "cartesian";
    case PidDirection::axes:
      return "axes";
  }
  return "";
}

std::optional<PidDirection> find_pid_direction(std::string_view name) noexcept {
  for (const PidDirection known :
       {PidDirection::polar, PidDirection::cartesian, PidDirection::axes}) {
    if (name == to_string(known)) return known;
  }
  return std::nullopt;
}

std::size_t PidLayout::payload_bytes(HidReportType type, std::uint8_t id) const noexcept {
  for (const HidReport& report : reports) {
    if (report.type == type && report.id == id) return report.bytes();
  }
  return 0;
}

tl::expected<PidLayout, std::string> find_pid_layout(const HidDescriptor& descriptor,
                                                     std::optional<PidDirection> wanted) {
  const Finder find(descriptor);
  PidLayout layout;
  std::optional<Missing> missing;
  if (!find_input(descriptor, find, layout)) missing = Missing{"an X axis in an input report"};
  if (!missing) missing = find_force(find, layout);
  if (!missing) missing = find_effect(find, layout);
  if (!missing) missing = find_directions(find, layout, wanted);
  if (!missing) missing = find_operation(find, layout);
  if (!missing) missing = find_memory(find, layout);
  if (missing) {
    return tl::make_unexpected(fmt::format("its report descriptor lacks {}", missing->what));
  }
  layout.reset = find.choice(Finder::sent, anywhere, usages::device_reset);
  layout.stop_all = find.choice(Finder::sent, anywhere, usages::stop_all_effects);
  layout.enable = find.choice(Finder::sent, anywhere, usages::enable_actuators);
  layout.gain = find.field(Finder::sent, anywhere, usages::device_gain);
  return layout;
}

}  // namespace spm::servo
