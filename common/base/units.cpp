// SPDX-License-Identifier: Apache-2.0
#include "common/base/units.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <span>

namespace spm {
namespace {

/// A unit's SI value as a quotient, so that decimal text is rounded correctly: 50um is 50 / 1e6.
struct Unit {
  std::string_view name;
  double multiplier;
  double divisor;
  bool printed;  ///< whether format_quantity may choose it
};

struct QuantityFacts {
  std::string_view noun;
  std::string_view examples;
  std::span<const Unit> units;  ///< the units that are printed are in ascending order
};

constexpr std::array length_units{Unit{"um", 1, 1e6, true}, Unit{"mm", 1, 1e3, true},
                                  Unit{"cm", 1, 1e2, false}, Unit{"m", 1, 1, true},
                                  Unit{"in", 254, 1e4, false}};
constexpr std::array stiffness_units{Unit{"N/m", 1, 1, true}, Unit{"N/mm", 1e3, 1, true}};
constexpr std::array force_units{Unit{"mN", 1, 1e3, true}, Unit{"N", 1, 1, true}};
constexpr std::array speed_units{Unit{"mm/s", 1, 1e3, true}, Unit{"m/s", 1, 1, true}};
constexpr std::array angle_units{Unit{"deg", std::numbers::pi, 180, true},
                                 Unit{"rad", 1, 1, false}};
constexpr std::array damping_units{Unit{"Ns/m", 1, 1, true}, Unit{"N s/m", 1, 1, false},
                                   Unit{"Ns/mm", 1e3, 1, false}};
constexpr std::array angular_speed_units{Unit{"deg/s", std::numbers::pi, 180, true},
                                         Unit{"rad/s", 1, 1, false}};
constexpr std::array mass_units{Unit{"g", 1, 1e3, true}, Unit{"kg", 1, 1, true}};
constexpr std::array rate_units{Unit{"Hz", 1, 1, true}, Unit{"kHz", 1e3, 1, true}};
constexpr std::array torque_units{Unit{"mN m", 1, 1e3, true}, Unit{"mNm", 1, 1e3, false},
                                  Unit{"N m", 1, 1, true}, Unit{"Nm", 1, 1, false}};
constexpr std::array turning_stiffness_units{
    Unit{"mN m/rad", 1, 1e3, true}, Unit{"mNm/rad", 1, 1e3, false}, Unit{"N m/rad", 1, 1, true},
    Unit{"Nm/rad", 1, 1, false}};
constexpr std::array duration_units{Unit{"us", 1, 1e6, true}, Unit{"ms", 1, 1e3, true},
                                    Unit{"s", 1, 1, true}, Unit{"min", 60, 1, false}};
constexpr std::array per_length_units{Unit{"/m", 1, 1, true}, Unit{"/mm", 1e3, 1, true}};

QuantityFacts facts_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::length:
      return {"a length", "50um or 2mm", length_units};
    case Quantity::stiffness:
      return {"a stiffness", "800N/m or 1.5N/mm", stiffness_units};
    case Quantity::force:
      return {"a force", "500mN or 8N", force_units};
    case Quantity::speed:
      return {"a speed", "50mm/s or 0.1m/s", speed_units};
    case Quantity::angle:
      return {"an angle", "10deg or 0.2rad", angle_units};
    case Quantity::damping:
      return {"a damping", "2Ns/m", damping_units};
    case Quantity::mass:
      return {"a mass", "150g or 0.2kg", mass_units};
    case Quantity::per_length:
      return {"a number a length", "100/m or 0.1/mm", per_length_units};
    case Quantity::angular_speed:
      return {"an angular speed", "7000deg/s or 120rad/s", angular_speed_units};
    case Quantity::rate:
      return {"a rate", "500Hz or 1kHz", rate_units};
    case Quantity::torque:
      return {"a torque", "100mNm or 0.1N m", torque_units};
    case Quantity::turning_stiffness:
      return {"a turning stiffness", "500mNm/rad or 2N m/rad", turning_stiffness_units};
    case Quantity::duration:
      return {"a time", "400us or 1ms", duration_units};
  }
  return {"a quantity", "", {}};
}

std::string quoted(std::string_view text) {
  std::string result(1, '\'');
  result.append(text).push_back('\'');
  return result;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// A unit's name with `u` for each micro sign (U+00B5) and Greek mu (U+03BC), in UTF-8.
std::string with_plain_micro(std::string_view name) {
  std::string plain;
  while (!name.empty()) {
    const bool micro = name.starts_with("\xC2\xB5") || name.starts_with("\xCE\xBC");
    plain += micro ? 'u' : name.front();
    name.remove_prefix(micro ? 2 : 1);
  }
  return plain;
}

std::string names_of(std::span<const Unit> units) {
  std::string names;
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (i > 0) names += i + 1 == units.size() ? " or " : ", ";
    names += units[i].name;
  }
  return names;
}

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::general, 4);
  return {buffer.data(), end.ptr};
}

}  // namespace

Result<double> parse_quantity(std::string_view text, Quantity quantity) {
  const QuantityFacts facts = facts_of(quantity);
  const std::string cure =
      "write " + std::string(facts.noun) + " such as " + std::string(facts.examples);
  const std::string_view whole = trimmed(text);
  double number = 0;
  const auto [end, problem] = std::from_chars(whole.data(), whole.data() + whole.size(), number);
  if (problem == std::errc::invalid_argument) {
    return fail(ExitCode::usage, quoted(text) + " is not a number with a unit: " + cure);
  }
  if (problem == std::errc::result_out_of_range || !std::isfinite(number)) {
    return fail(ExitCode::usage, quoted(text) + " is not a finite number: " + cure);
  }
  const std::string_view name = trimmed(whole.substr(static_cast<std::size_t>(end - whole.data())));
  if (name.empty()) return fail(ExitCode::usage, quoted(text) + " has no unit: " + cure);
  const std::string plain = with_plain_micro(name);
  for (const Unit& unit : facts.units) {
    if (unit.name != plain) continue;
    const double value = number * unit.multiplier / unit.divisor;
    if (std::isfinite(value)) return value;
    return fail(ExitCode::usage, quoted(text) + " is not a finite number: " + cure);
  }
  return fail(ExitCode::usage, quoted(text) + " has the unknown unit " + quoted(name) + ": write " +
                                   std::string(facts.noun) + " in " + names_of(facts.units) +
                                   ", such as " + std::string(facts.examples));
}

std::string format_quantity(double in_si, Quantity quantity) {
  const std::span<const Unit> units = facts_of(quantity).units;
  const Unit* best = nullptr;
  for (const Unit& unit : units) {
    if (!unit.printed) continue;
    // The margin below 1 keeps a value such as 0.99999 mm from being printed as 1000 um.
    if (best == nullptr || std::abs(in_si) * unit.divisor / unit.multiplier >= 0.99995)
      best = &unit;
  }
  const Unit& unit = best != nullptr ? *best : units.front();
  return shortest(in_si * unit.divisor / unit.multiplier) + " " + std::string(unit.name);
}

Result<double> parse_probe(std::string_view text) {
  constexpr std::string_view prefix = "sphere:";
  if (text == "point") return 0.0;
  if (!text.starts_with(prefix)) {
    return fail(
        ExitCode::usage,
        quoted(text) + " is not a probe: write point or sphere:RADIUS such as sphere:0.5mm");
  }
  const Result<double> radius = parse_quantity(text.substr(prefix.size()), Quantity::length);
  if (!radius) return fail(ExitCode::usage, quoted(text) + ": " + radius.error().message);
  if (*radius <= 0) {
    return fail(ExitCode::usage, quoted(text) + " has no size: write point or a radius above 0");
  }
  return *radius;
}

Result<double> parse_mesh_unit(std::string_view text) {
  constexpr std::array units{Unit{"m", 1, 1, true}, Unit{"mm", 1, 1e3, true},
                             Unit{"cm", 1, 1e2, true}, Unit{"in", 254, 1e4, true}};
  for (const Unit& unit : units) {
    if (unit.name == text) return unit.multiplier / unit.divisor;
  }
  return fail(ExitCode::usage, quoted(text) + " is not a unit of a mesh: write m, mm, cm or in");
}

}  // namespace spm
