// SPDX-License-Identifier: Apache-2.0
#include "formats/cli/progress_text.hpp"

#include <catch2/catch.hpp>

namespace progress_text_test {

using spm::cli::progress_text;

TEST_CASE("A progress line tells the stage and its share done") {
  CHECK(progress_text("casting", {.done = 0}) == "casting   0 %");
  CHECK(progress_text("casting", {.done = 0.4, .seconds = 0.9}) == "casting  40 %");
  CHECK(progress_text("casting", {.done = 1.2, .seconds = 0.9}) == "casting 100 %");
}

TEST_CASE("A stage that has been going for more than a second tells what it still takes") {
  CHECK(progress_text("casting", {.done = 0.4, .seconds = 4}) == "casting  40 %, about 6 s left");
  CHECK(progress_text("casting", {.done = 0.999, .seconds = 4}) == "casting 100 %, about 1 s left");
  CHECK(progress_text("casting", {.done = 0.5, .seconds = 200}) ==
        "casting  50 %, about 3 min left");
  CHECK(progress_text("casting", {.done = 0.01, .seconds = 180}) ==
        "casting   1 %, about 5 h left");
}

TEST_CASE("What was done before a stage was first heard of does not count for its pace") {
  CHECK(progress_text("casting", {.done = 0.75, .start = 0.5, .seconds = 5}) ==
        "casting  75 %, about 5 s left");
}

TEST_CASE("A stage that has not moved, or is done, tells no time left") {
  CHECK(progress_text("verify", {.done = 0, .seconds = 30}) == "verify   0 %");
  CHECK(progress_text("casting", {.done = 0.5, .start = 0.5, .seconds = 5}) == "casting  50 %");
  CHECK(progress_text("casting", {.done = 1, .seconds = 30}) == "casting 100 %");
}

}  // namespace progress_text_test
