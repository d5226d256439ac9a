// SPDX-License-Identifier: Apache-2.0
#include "formats/motion/trajectory.hpp"

#include <catch2/catch.hpp>
#include <clocale>
#include <cstdlib>
#include <filesystem>

#include "tests/formats/support/synthetic_asset.hpp"
#include "tests/support/skip.hpp"

namespace trajectory_test {

namespace {

using namespace spm;
using namespace spm::test;

Result<std::vector<TrajectorySample>> read(const std::string& text) {
  const TemporaryFolder folder;
  write_bytes(folder.path("path.txt"), text);
  return read_trajectory(folder.path("path.txt"));
}

}  // namespace

TEST_CASE("A trajectory takes spaces, tabs, commas, comments, blank lines and Windows line ends") {
  const auto samples = read("# x y z\n1 2 3\r\n\n\t4,5,\t-6e-1 # end\n+7, 8 ,9 1 0 0 0\n10 11 12");
  REQUIRE(samples.has_value());
  REQUIRE(samples->size() == 4);
  CHECK((*samples)[0].position == Vector3(1, 2, 3));
  CHECK((*samples)[1].position == Vector3(4, 5, -0.6));
  CHECK((*samples)[2].position == Vector3(7, 8, 9));
  CHECK((*samples)[3].position == Vector3(10, 11, 12));
}

TEST_CASE("A trajectory's orientation is w x y z, made unit") {
  const auto samples = read("0 0 0 0.70711 0 -0.70711 0\n");
  REQUIRE(samples.has_value());
  CHECK((*samples)[0].qw == Approx(std::sqrt(0.5)).epsilon(1e-12));
  CHECK((*samples)[0].qy == Approx(-std::sqrt(0.5)).epsilon(1e-12));
}

TEST_CASE("A wrong line of a trajectory is refused by its number and cause") {
  struct Case {
    const char* text;
    const char* place;
    const char* cause;
  };
  for (const Case& wrong : {
           Case{"1 2 3\n1 2\n", "line 2", "2 numbers"},
           Case{"1\n", "line 1", "1 number;"},
           Case{"\n\n1 2 3 4\n", "line 3", "4 numbers"},
           Case{"1 2 3 4 5 6 7 8\n", "line 1", "more than seven"},
           Case{"1 2 x\n", "line 1", "x is not a number"},
           Case{"1 2 3m\n", "line 1", "3m is not a number"},
           Case{"1 2 ++3\n", "line 1", "++3 is not a number"},
           Case{"1 2 nan\n", "line 1", "not finite"},
           Case{"1 2 -inf\n", "line 1", "not finite"},
           Case{"1 2 1e999\n", "line 1", "is not a number"},
           Case{"1 2 3 2 0 0 0\n", "line 1", "unit length"},
           Case{"1 2 3 0 0 0 0\n", "line 1", "unit length"},
           Case{"\x7f"
                "ELF\x02\x01\n",
                "line 1", "is not a number"},
           Case{"", "", "holds no points"},
           Case{"# only a comment\n\n", "", "holds no points"},
       }) {
    INFO(wrong.text);
    const auto samples = read(wrong.text);
    REQUIRE(!samples);
    CHECK(samples.error().code == ExitCode::invalid_input);
    CHECK(samples.error().message.find("path.txt: ") != std::string::npos);
    CHECK(samples.error().message.find(wrong.place) != std::string::npos);
    CHECK(samples.error().message.find(wrong.cause) != std::string::npos);
    CHECK(samples.error().message.find("; ") != std::string::npos);
  }
}

TEST_CASE("A missing trajectory and a folder are file errors") {
  const TemporaryFolder folder;
  for (const std::string& path : {folder.path("missing.txt"), folder.folder()}) {
    const auto samples = read_trajectory(path);
    REQUIRE(!samples);
    CHECK(samples.error().code == ExitCode::file_or_device);
    CHECK(samples.error().message.find(path) == 0);
  }
}

TEST_CASE("Numbers are read the same in a locale with decimal commas") {
  const char* set = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const auto samples = read("0.5 1.25 2\n");
  std::setlocale(LC_ALL, "C");
  if (set == nullptr) SPM_SKIP("the locale de_DE.UTF-8 is not there");
  REQUIRE(samples.has_value());
  CHECK((*samples)[0].position == Vector3(0.5, 1.25, 2));
}

TEST_CASE("The shared trajectories are read whole") {
  const char* named = std::getenv("SPM_SHARED");
  const std::string shared = named != nullptr ? named : SPM_SHARED_FOLDER;
  if (!std::filesystem::exists(shared + "/trajectories/teeth-slide.txt")) {
    SPM_SKIP("there are no shared trajectories in " << shared);
  }
  const auto samples = read_trajectory(shared + "/trajectories/teeth-slide.txt");
  REQUIRE(samples.has_value());
  CHECK(samples->size() == 20000);
}

}  // namespace trajectory_test
