// SPDX-License-Identifier: Apache-2.0
// The ends of the ranges in which the numbers of a command may be.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "servo/shared/app_command.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

namespace app_command_bounds_test {

using namespace spm;
using namespace spm::servo;

namespace {

constexpr std::int64_t now = 1'000'000;

Refusal refusal_of(const spm_shared_command& command, AppCommand& read) {
  return check_command(command, {1, 1, now}, read);
}
Refusal refusal_of(const spm_shared_command& command) {
  AppCommand ignored;
  return refusal_of(command, ignored);
}

/// A complete command of a kind.
spm_shared_command command_of(std::uint32_t kind) {
  spm_shared_command command = test::move_command(0, 0.1);
  command.kind = kind;
  return command;
}

}  // namespace

TEST_CASE("A texture's wavelength is at least a micrometre where it has an amplitude") {
  spm_shared_command command = command_of(SPM_COMMAND_MATERIAL);
  command.fields = SPM_MATERIAL_TEXTURE;
  command.texture_amplitude = 5e-5;
  for (const double wavelength : {1e-6, 1e-3, 1.0}) {
    command.texture_wavelength = wavelength;
    CHECK(refusal_of(command) == Refusal::none);
  }
  for (const double wavelength : {0.0, 0.5e-6, 0.999e-6, 1.001}) {
    command.texture_wavelength = wavelength;
    CHECK(refusal_of(command) == Refusal::out_of_range);
  }
  command.texture_amplitude = 0;
  command.texture_wavelength = 0;
  CHECK(refusal_of(command) == Refusal::none);
}

TEST_CASE("A command is taken up to its deadline, that very time included") {
  spm_shared_command command = command_of(SPM_COMMAND_MOVE);
  for (const std::int64_t deadline : {now, now + 1, std::int64_t{0}, std::int64_t{-5}}) {
    command.deadline_ns = deadline;
    CHECK(refusal_of(command) == Refusal::none);
  }
  command.deadline_ns = now - 1;
  CHECK(refusal_of(command) == Refusal::too_late);
}

TEST_CASE("A hand is led for a time that is a number, above nothing and up to a second") {
  spm_shared_command command = command_of(SPM_COMMAND_LEAD);
  command.on = 1;
  for (const double hold : {1e-6, 0.1, 1.0}) {
    command.hold = hold;
    AppCommand read;
    CHECK(refusal_of(command, read) == Refusal::none);
    CHECK(read.hold == hold);
  }
  for (const double hold : {0.0, -0.1, 1.0001, 1e300}) {
    command.hold = hold;
    CHECK(refusal_of(command) == Refusal::out_of_range);
  }
  for (const double hold : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    command.hold = hold;
    CHECK(refusal_of(command) == Refusal::not_finite);
  }
  // Of one that is let go the time does not matter.
  command.on = 0;
  command.hold = 0;
  CHECK(refusal_of(command) == Refusal::none);
}

TEST_CASE("The axis of detents is of unit length, to a thousandth, and is made so") {
  spm_shared_command command = command_of(SPM_COMMAND_EFFECT);
  command.effect_kind = SPM_EFFECT_DETENTS;
  command.stiffness = 100;
  command.spacing = 0.005;
  for (const double length : {0.9995, 1.0, 1.0005}) {
    command.axis[0] = 0.6 * length;
    command.axis[1] = 0.8 * length;
    AppCommand read;
    CHECK(refusal_of(command, read) == Refusal::none);
    CHECK(read.effect.axis.norm() == Approx(1).epsilon(1e-12));
  }
  for (const double length : {0.0, 0.5, 0.998, 1.002, 1.9}) {
    command.axis[0] = 0.6 * length;
    command.axis[1] = 0.8 * length;
    CHECK(refusal_of(command) == Refusal::out_of_range);
  }
}

}  // namespace app_command_bounds_test
