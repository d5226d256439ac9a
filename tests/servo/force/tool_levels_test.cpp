// SPDX-License-Identifier: Apache-2.0
#include "servo/force/tool_levels.hpp"

#include <catch2/catch.hpp>

namespace spm::tool_levels_test {
namespace {

constexpr std::uint32_t last = 5;

ToolEffort in_time() {
  ToolEffort effort;
  effort.level = last;
  effort.worked = 1000;
  return effort;
}

ToolEffort late_in_steps(std::uint32_t looks = 2) {
  ToolEffort effort = in_time();
  effort.steps_late = true;
  effort.looks = looks;
  return effort;
}

TEST_CASE("Two ticks that have no time for steps make the next coarser, one alone does not") {
  ToolLevels levels;
  levels.note(late_in_steps(), last);
  CHECK(levels.finest() == ToolLevels::every);
  for (int tick = 0; tick < 20; ++tick) levels.note(in_time(), last);
  levels.note(late_in_steps(), last);
  CHECK(levels.finest() == ToolLevels::every);
  levels.note(late_in_steps(), last);
  CHECK(levels.finest() == last - 1);
  // And so on.
  levels.note(late_in_steps(), last);
  CHECK(levels.finest() == last - 1);
  levels.note(late_in_steps(), last);
  CHECK(levels.finest() == last - 2);
}

TEST_CASE("Ticks that have time for some steps, or hardly begin, leave the next as fine") {
  ToolLevels levels;
  for (int tick = 0; tick < 20; ++tick) levels.note(late_in_steps(4), last);
  ToolEffort hardly = late_in_steps();
  hardly.worked = 100;
  for (int tick = 0; tick < 20; ++tick) levels.note(hardly, last);
  CHECK(levels.finest() == ToolLevels::every);
}

TEST_CASE("Where looks are late the next go to the level that this one came to") {
  ToolLevels levels;
  ToolEffort late = in_time();
  late.looks_late = true;
  late.level = last - 1;
  levels.note(late, last);
  levels.note(late, last);
  CHECK(levels.finest() == last - 1);
}

TEST_CASE("The first ticks on a finer level, which find its samples, may be late") {
  ToolLevels levels;
  levels.note(late_in_steps(), last);
  levels.note(late_in_steps(), last);
  REQUIRE(levels.finest() == last - 1);
  for (int tick = 0; levels.finest() != ToolLevels::every; ++tick) {
    REQUIRE(tick < 20);
    levels.note(in_time(), last);
  }
  for (int tick = 0; tick < 4; ++tick) levels.note(late_in_steps(), last);
  CHECK(levels.finest() == ToolLevels::every);
  // If that goes on it was in vain.
  levels.note(late_in_steps(), last);
  levels.note(late_in_steps(), last);
  CHECK(levels.finest() == last - 1);
}

TEST_CASE("A finer level that fails again and again is tried more and more seldom") {
  ToolLevels levels;
  std::uint32_t trials = 0, coarse = 0;
  constexpr std::uint32_t ticks = 16000;
  for (std::uint32_t tick = 0; tick < ticks; ++tick) {
    const bool fine = levels.finest() >= last - 1;
    trials += fine ? 1 : 0;
    coarse += fine ? 0 : 1;
    levels.note(fine ? late_in_steps() : in_time(), last);
  }
  CHECK(trials < ticks / 100);
  CHECK(trials > 10);
  CHECK(coarse > ticks * 9 / 10);
  // Once there is time enough it comes back, and is as quick to try as at first.
  int back = 0;
  while (levels.finest() != ToolLevels::every) {
    levels.note(in_time(), last);
    REQUIRE(++back < 4000);
  }
  for (int tick = 0; tick < 2000; ++tick) levels.note(in_time(), last);
  levels.note(late_in_steps(), last);
  levels.note(late_in_steps(), last);
  REQUIRE(levels.finest() == last - 1);
  for (int tick = 0; tick < 8; ++tick) levels.note(in_time(), last);
  CHECK(levels.finest() == ToolLevels::every);
}

}  // namespace
}  // namespace spm::tool_levels_test
