// SPDX-License-Identifier: Apache-2.0
// What applications, pages and viewers say: commands of any bytes, and texts.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "servo/foxglove/foxglove_client.hpp"
#include "servo/shared/app_command.hpp"
#include "servo/view/view_wishes.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace spm::fuzz {

namespace {

constexpr char of_application = 'a';

void check(const spm_shared_command& command) {
  servo::AppCommand read;
  const servo::AppCommandLimits limits{2, 2, 1'000'000};
  if (servo::check_command(command, limits, read) != servo::Refusal::none) return;
  require(read.pose.position.allFinite() && read.pose.rotation.coeffs().allFinite() &&
              std::abs(read.pose.rotation.norm() - 1) < 1e-9 && read.pose.scale > 0,
          "a pose that was accepted is one");
  const servo::AppMaterial& material = read.material;
  // Of a hand that is let go nothing else counts.
  const bool is_held = read.action != servo::AppAction::lead || read.on;
  const double numbers[] = {read.period,
                            read.force_cap,
                            is_held ? read.hold : 0,
                            material.stiffness,
                            material.friction_stick,
                            material.friction_slide,
                            material.damping,
                            material.texture.amplitude,
                            material.texture.wavelength,
                            read.effect.stiffness,
                            read.effect.damping};
  require(
      std::all_of(std::begin(numbers), std::end(numbers),
                  [](double number) { return number >= 0 && number <= servo::app_max_stiffness; }),
      "a number that was accepted is in range");
  require(read.force.allFinite() && read.torque.allFinite() && read.effect.point.allFinite(),
          "a vector that was accepted is one");
  require(std::abs(read.effect.axis.norm() - 1) < 1e-9 || read.effect.axis.isZero(),
          "an axis that was accepted is of unit length");
}

}  // namespace

std::vector<std::string> seeds() {
  std::vector<std::string> made;
  for (std::uint32_t kind = 1; kind <= SPM_COMMAND_ACKNOWLEDGE; ++kind) {
    spm_shared_command command{};
    command.kind = kind;
    command.orientation[0] = command.scale = command.axis[0] = command.effect_kind = 1;
    command.hold = command.spacing = 0.1;
    command.fields = SPM_MATERIAL_ALL;
    made.push_back(std::string(1, of_application) +
                   std::string(reinterpret_cast<const char*>(&command), sizeof command));
  }
  made.insert(made.end(),
              {R"({"t":"hand","device":0,"p":[0,0,0],"q":[1,0,0,0],"n":5})",
               R"({"t":"feel","object":1,"stiffness":800,"friction":[0.5,0.4],"texture":[0,1]})",
               R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]})",
               R"({"op":"unsubscribe","subscriptionIds":[0]})"});
  return made;
}

std::vector<std::string> endings() { return {".message"}; }

}  // namespace spm::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  if (data[0] == spm::fuzz::of_application) {
    spm_shared_command command{};
    std::memcpy(&command, data + 1, std::min(size - 1, sizeof command));
    spm::fuzz::check(command);
    return 0;
  }
  const std::string text(reinterpret_cast<const char*>(data), size);
  static_cast<void>(spm::servo::read_wish(text));
  spm::servo::FoxgloveClient client;
  spm::servo::FoxgloveChannel channel;
  channel.id = 1;
  static_cast<void>(client.offer({channel}));
  static_cast<void>(client.hear(text));
  return 0;
}
