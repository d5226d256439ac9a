// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_options.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <string>

namespace falcon_options_test {

using namespace spm::servo;

namespace {

/// The environment's firmware file for the length of a test.
class FirmwareInEnvironment {
 public:
  explicit FirmwareInEnvironment(const char* file) {
    const char* const before = std::getenv("FALCON_FIRMWARE");
    had_ = before != nullptr;
    if (had_) before_ = before;
    file != nullptr ? setenv("FALCON_FIRMWARE", file, 1) : unsetenv("FALCON_FIRMWARE");
  }
  FirmwareInEnvironment(const FirmwareInEnvironment&) = delete;
  FirmwareInEnvironment& operator=(const FirmwareInEnvironment&) = delete;
  ~FirmwareInEnvironment() {
    had_ ? setenv("FALCON_FIRMWARE", before_.c_str(), 1) : unsetenv("FALCON_FIRMWARE");
  }

 private:
  bool had_ = false;
  std::string before_;
};

}  // namespace

TEST_CASE("Without options any Falcon is taken, without a firmware file, at its full force") {
  const FirmwareInEnvironment none(nullptr);
  const auto options = parse_falcon_options("");
  REQUIRE(options);
  REQUIRE(options->firmware.empty());
  REQUIRE(options->path.empty());
  REQUIRE(options->product == falcon_product);
  REQUIRE(options->force_cap == 8);
  REQUIRE(options->home_angle == falcon_home_angle);
}

TEST_CASE("Every option of a Falcon is read with its unit") {
  const auto options =
      parse_falcon_options("firmware=/opt/f w.bin,path=1-2.3,force_cap=500mN,home_angle=34.5deg");
  REQUIRE(options);
  REQUIRE(options->firmware == "/opt/f w.bin");
  REQUIRE(options->path == "1-2.3");
  REQUIRE(options->force_cap == 0.5);
  REQUIRE(options->home_angle == Approx(34.5 * std::numbers::pi / 180));
  REQUIRE(parse_falcon_options("product=6001")->product == 0x6001);
  REQUIRE(parse_falcon_options("path=12-4")->path == "12-4");
  REQUIRE(parse_falcon_options("path=1-2.3.4.10")->path == "1-2.3.4.10");
  REQUIRE(parse_falcon_options("force_cap=8N")->force_cap == 8);
}

TEST_CASE("The environment names the firmware file where the options do not") {
  const FirmwareInEnvironment named("/env.bin");
  REQUIRE(parse_falcon_options("")->firmware == "/env.bin");
  REQUIRE(parse_falcon_options("path=1-1")->firmware == "/env.bin");
  REQUIRE(parse_falcon_options("firmware=/own.bin")->firmware == "/own.bin");
}

TEST_CASE("A wrong option of a Falcon is a usage error that says what would do") {
  const auto [text, hint] = GENERATE(table<std::string, std::string>({
      {"colour=red", "firmware, path, product, force_cap and home_angle"},
      {"product=", "product=6001"},
      {"product=60", "product=6001"},
      {"product=0x6001", "product=6001"},
      {"product=16001", "product=6001"},
      {"product=600g", "product=6001"},
      {"product=-001", "product=6001"},
      {"firmware=", "empty"},
      {"path=", "1-2.3"},
      {"path=1", "1-2.3"},
      {"path=1-", "1-2.3"},
      {"path=1-2.", "1-2.3"},
      {"path=1-2.3x", "1-2.3"},
      {"path=/dev/ttyUSB0", "1-2.3"},
      {"path=1000-1", "1-2.3"},
      {"force_cap=5", "unit"},
      {"force_cap=0N", "out of range"},
      {"force_cap=-1N", "out of range"},
      {"force_cap=8.1N", "at most 8 N"},
      {"force_cap=1mm", ""},
      {"home_angle=0deg", "at least 25 deg"},
      {"home_angle=90deg", "at most 45 deg"},
      {"firmware", "option=value"},
      {",", "option=value"},
  }));
  CAPTURE(text);
  const auto options = parse_falcon_options(text);
  REQUIRE_FALSE(options);
  REQUIRE(options.error().code == spm::ExitCode::usage);
  REQUIRE(options.error().message.find(hint) != std::string::npos);
}

}  // namespace falcon_options_test
