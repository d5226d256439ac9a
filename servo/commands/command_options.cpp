// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>

#include "common/base/units.hpp"
#include "servo/commands/commands.hpp"

namespace spm::servo {

namespace {

constexpr double slowest = 500;   // Hz
constexpr double fastest = 4000;  // Hz

}  // namespace

void add_force_options(CLI::App& command, ForceOptions& options) {
  command.add_option("--asset", options.asset, "Baked asset, FILE.spm.exr")->type_name("FILE");
  command
      .add_option("--scene", options.scene,
                  "Objects with their places, stiffnesses and effects (TOML), instead of --asset; "
                  "what else the command line gives wins, for every object")
      ->type_name("SCENE.toml");
  constexpr std::array methods{Method::spm, Method::paper, Method::proxy};
  cli::add_word(
      command, "--method", {"spm", "paper", "proxy"},
      [&options, methods](std::size_t i) { options.method = methods[i]; },
      "How forces are made: proxy (default), by a point that the surface holds back; spm, by the "
      "depth in the surface; or paper, the paper's equations to the letter, for assets baked with "
      "--form full. spm and paper without a scene are not stabilized");
  cli::add_word(
      command, "--paper-rule", {paper_rule_words.begin(), paper_rule_words.end()},
      [&options](std::size_t i) { options.rule = static_cast<PaperRule>(i); },
      "Reading of the paper's rule that picks the plane (default closest-plane)");
  cli::add_parsed(
      command, "--stiffness",
      [&options](const std::string& text) -> Result<void> {
        options.stiffness_chosen = text == "auto";
        if (options.stiffness_chosen) return {};
        const Result<double> value = parse_quantity(text, Quantity::stiffness);
        if (!value) return tl::make_unexpected(value.error());
        options.stiffness = *value;
        return {};
      },
      "Stiffness of the contact; auto: what the device renders stably (default: what the scene "
      "says, "
      "or auto; in a replay without a device 1N/mm)",
      "STIFFNESS|auto");
  cli::add_parsed(
      command, "--probe",
      [&options](const std::string& text) -> Result<void> {
        const Result<ProbeShape> probe = parse_probe_shape(text);
        if (!probe) return tl::make_unexpected(probe.error());
        options.probe = *probe;
        return {};
      },
      "What touches the object (default point); RADIUS and LENGTH are lengths such as 0.5mm. A "
      "capsule, along the hand's z axis, is of method paper alone; LENGTH is from the centre of "
      "one "
      "of its ends to that of the other",
      probe_forms);
  constexpr std::array forms{PaperProbeForm::surface, PaperProbeForm::volume};
  cli::add_word(
      command, "--paper-probe", {"surface", "volume"},
      [&options, forms](std::size_t i) { options.probe_form = forms[i]; },
      "What the force of method paper on a probe with a size is the mean over: its surface, eq. 10 "
      "and 11 (default), or its volume");
  cli::add_parsed(
      command, "--stabilization",
      [&options](const std::string& text) -> Result<void> {
        StabilizationSettings stabilization;
        if (text != "none" && !parse_stabilization(text, stabilization)) {
          return fail(ExitCode::usage,
                      "'" + text +
                          "' will not do: write none, recommended, or some of damping, "
                          "coupling, passivity and potential, joined by +");
        }
        options.stabilization = stabilization;
        return {};
      },
      "What keeps stiff contacts from shaking (default: what the scene says, or recommended): "
      "recommended is damping+passivity",
      "none|recommended|WORDS");
}

CLI::Option* add_number(CLI::App& command, const std::string& name, double min, double max,
                        double& target, const std::string& description) {
  return command.add_option_function<std::string>(
      name,
      [name, min, max, &target](const std::string& text) {
        const char* end = text.data() + text.size();
        double value = 0;
        const auto parsed = std::from_chars(text.data(), end, value);
        // Written so that NaN is out of range.
        if (parsed.ec != std::errc{} || parsed.ptr != end || !(value >= min && value <= max)) {
          throw CLI::ValidationError(
              name, fmt::format("'{}' will not do: write a number from {} to {}", text, min, max));
        }
        target = value;
      },
      description);
}

void add_rate_option(CLI::App& command, double& rate_hz) {
  cli::add_parsed(
      command, "--rate",
      [&rate_hz](const std::string& text) -> Result<void> {
        const char* end = text.data() + text.size();
        double value = 0;
        const auto bare = std::from_chars(text.data(), end, value);
        if (bare.ec != std::errc{} || bare.ptr != end) {
          value = parse_quantity(text, Quantity::rate).value_or(0);
        }
        // Written so that NaN is out of range.
        if (!(value >= slowest && value <= fastest)) {
          return fail(ExitCode::usage,
                      fmt::format("'{}' will not do: write a number from {} to {}, such as 1000, "
                                  "1000Hz or 1kHz",
                                  text, slowest, fastest));
        }
        rate_hz = value;
        return {};
      },
      "Ticks a second, 500 to 4000 (default 1000); 1000Hz and 1kHz are the same", "HZ");
}

void add_device_number(CLI::App& command, double& number, const std::string& description) {
  add_number(command, "--device-number", 0, 65535, number, description)->type_name("N");
}

Result<void> check_device_number(double number, const std::string& recording, std::size_t devices) {
  if (number == std::floor(number) && number < static_cast<double>(devices)) return {};
  return fail(ExitCode::usage,
              fmt::format("--device-number {}: {} is of {} device{}, counted from 0", number,
                          recording, devices, devices == 1 ? "" : "s"));
}

}  // namespace spm::servo
