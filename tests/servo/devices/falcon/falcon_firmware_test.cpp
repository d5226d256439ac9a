// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/falcon/falcon_firmware.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <limits>
#include <string>

#include "common/base/random.hpp"
#include "tests/servo/devices/falcon/scripted_falcon.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace falcon_firmware_test {

using namespace spm;
using namespace spm::servo;
using spm::test::FalconFaults;
using spm::test::ScriptedFalcon;
using std::chrono::milliseconds;

namespace {

constexpr std::size_t firmware_size = 8492;

std::vector<std::uint8_t> some_firmware(std::size_t size = firmware_size) {
  Random random(1);
  std::vector<std::uint8_t> bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.next());
  bytes[0] = 0xAA;
  bytes[1] = 0x08;
  return bytes;
}

/// A link to a scripted Falcon, over which bytes come in parts and the device can be unplugged.
class ScriptedLink final : public ByteLink {
 public:
  explicit ScriptedLink(ScriptedFalcon& falcon) : falcon_(falcon) {}

  std::size_t max_a_read = 62;                                           ///< bytes
  std::size_t transfers_left = std::numeric_limits<std::size_t>::max();  ///< until it is unplugged
  int failing_writes = 0;
  std::size_t reads = 0;
  std::size_t stop_at_read = 0;       ///< 0: never
  std::atomic<bool>* stop = nullptr;  ///< set at that read
  milliseconds waited{0};             ///< for what did not come

  LinkStatus control(std::uint8_t request, std::uint16_t value) override {
    if (unplugged()) return LinkStatus::gone;
    falcon_.control(request, value);
    return LinkStatus::done;
  }
  LinkResult write(std::span<const std::uint8_t> bytes, milliseconds timeout) override {
    if (unplugged()) return {LinkStatus::gone, 0};
    longest_write_ = std::max(longest_write_, bytes.size());
    if (failing_writes > 0) {
      --failing_writes;
      waited += timeout;
      return {LinkStatus::failed, 0};
    }
    falcon_.receive(bytes);
    return {LinkStatus::done, bytes.size()};
  }
  LinkResult read(std::span<std::uint8_t> bytes, milliseconds timeout) override {
    if (unplugged()) return {LinkStatus::gone, 0};
    if (++reads == stop_at_read) stop->store(true);
    auto& waiting = falcon_.outgoing();
    const std::size_t size = std::min({waiting.size(), bytes.size(), max_a_read});
    std::copy_n(waiting.begin(), size, bytes.begin());
    waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(size));
    if (size > 0) return {LinkStatus::done, size};
    waited += timeout;
    return {LinkStatus::timed_out, 0};
  }

  [[nodiscard]] std::size_t longest_write() const { return longest_write_; }

 private:
  bool unplugged() {
    if (transfers_left == 0) return true;
    --transfers_left;
    return false;
  }

  ScriptedFalcon& falcon_;
  std::size_t longest_write_ = 0;
};

const FalconUploadLimits no_back_off{10, 25, milliseconds(0), milliseconds(0)};

std::string failure_of(const Result<void>& result) {
  REQUIRE_FALSE(result);
  REQUIRE(result.error().code == ExitCode::file_or_device);
  return result.error().message;
}

bool says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("A Falcon without firmware takes the file whole, and answers packets then") {
  ScriptedFalcon falcon(firmware_size);
  ScriptedLink link(falcon);
  const std::atomic<bool> stop{false};
  REQUIRE(set_falcon_normal_mode(link));
  const auto runs = falcon_firmware_runs(link, stop);
  REQUIRE(runs);
  REQUIRE_FALSE(*runs);

  const auto firmware = some_firmware();
  REQUIRE(upload_falcon_firmware(link, firmware, stop, no_back_off));
  REQUIRE(falcon.loaded() == firmware);
  REQUIRE(falcon.boots() == 1);
  REQUIRE(falcon.boot_latency_ms() == 16);
  REQUIRE(falcon.latency_ms() == 1);
  REQUIRE(link.longest_write() <= 62);
  REQUIRE(falcon.packets() >= 1);
  REQUIRE(falcon.packets() == falcon.homing_packets());
  REQUIRE(falcon.pushing_packets() == 0);
  const auto runs_now = falcon_firmware_runs(link, stop);
  REQUIRE(runs_now);
  REQUIRE(*runs_now);
}

TEST_CASE("A Falcon whose firmware runs is found to, and nothing is loaded") {
  ScriptedFalcon falcon(firmware_size, {}, true);
  ScriptedLink link(falcon);
  REQUIRE(set_falcon_normal_mode(link));
  const auto runs = falcon_firmware_runs(link, false);
  REQUIRE(runs);
  REQUIRE(*runs);
  REQUIRE(falcon.boots() == 0);
  REQUIRE(falcon.latency_ms() == 1);
}

TEST_CASE("A zero in front of the boot program's answer, and answers in parts, do no harm") {
  const bool zero = GENERATE(false, true);
  const std::size_t part = GENERATE(1, 3, 62);
  CAPTURE(zero, part);
  FalconFaults faults;
  faults.leading_zero = zero;
  ScriptedFalcon falcon(firmware_size, faults);
  ScriptedLink link(falcon);
  link.max_a_read = part;
  const auto firmware = some_firmware();
  REQUIRE(upload_falcon_firmware(link, firmware, false, no_back_off));
  REQUIRE(falcon.loaded() == firmware);
  REQUIRE(falcon.boots() == 1);
}

TEST_CASE("A file of any size is sent to its last byte") {
  for (const std::size_t size : {4096, 4154, 4155, 6200, 16384}) {
    CAPTURE(size);
    ScriptedFalcon falcon(size);
    ScriptedLink link(falcon);
    const auto firmware = some_firmware(size);
    REQUIRE(upload_falcon_firmware(link, firmware, false, no_back_off));
    REQUIRE(falcon.loaded() == firmware);
  }
}

TEST_CASE("The boot program is called until it answers") {
  FalconFaults faults;
  faults.unanswered_calls = 7;
  ScriptedFalcon falcon(firmware_size, faults);
  ScriptedLink link(falcon);
  REQUIRE(upload_falcon_firmware(link, some_firmware(), false, no_back_off));
  REQUIRE(falcon.calls() == 8);
  REQUIRE(falcon.boots() == 1);
}

TEST_CASE("A byte that came back wrong makes the whole upload be done again") {
  const std::size_t at = GENERATE(0, 61, 62, 1000, 8491);
  CAPTURE(at);
  FalconFaults faults;
  faults.wrong_echoes = 2;
  faults.wrong_echo_at = at;
  ScriptedFalcon falcon(firmware_size, faults);
  ScriptedLink link(falcon);
  const auto firmware = some_firmware();
  REQUIRE(upload_falcon_firmware(link, firmware, false, no_back_off));
  REQUIRE(falcon.loaded() == firmware);
  REQUIRE(falcon.boots() == 3);
}

TEST_CASE("An upload whose echo is always wrong names the byte, and gives up") {
  FalconFaults faults;
  faults.wrong_echoes = -1;
  ScriptedFalcon falcon(firmware_size, faults);
  ScriptedLink link(falcon);
  FalconUploadLimits limits = no_back_off;
  limits.attempts = 4;
  const std::string failure =
      failure_of(upload_falcon_firmware(link, some_firmware(), false, limits));
  REQUIRE(says(failure, "4 attempts"));
  REQUIRE(says(failure, "sending bytes 992 to 1053 of the file"));
  REQUIRE(says(failure, "byte 1000 came back as"));
  REQUIRE(says(failure, "another USB port"));
  REQUIRE(falcon.boots() == 4);
}

TEST_CASE("A device that never answers is told by its step, its cure, and in bounded time") {
  FalconFaults faults;
  faults.unanswered_calls = -1;
  ScriptedFalcon falcon(firmware_size, faults);
  ScriptedLink link(falcon);
  const std::string failure =
      failure_of(upload_falcon_firmware(link, some_firmware(), false, no_back_off));
  REQUIRE(says(failure, "calling the boot program: no answer came"));
  REQUIRE(says(failure, "power supply"));
  REQUIRE(falcon.calls() == 10 * 25);
  REQUIRE(link.waited <= std::chrono::seconds(15));
}

TEST_CASE("Firmware that was loaded but does not answer is an error that says so") {
  FalconFaults faults;
  faults.dumb_firmware = true;
  ScriptedFalcon falcon(firmware_size, faults);
  ScriptedLink link(falcon);
  FalconUploadLimits limits = no_back_off;
  limits.attempts = 1;
  const std::string failure =
      failure_of(upload_falcon_firmware(link, some_firmware(), false, limits));
  REQUIRE(says(failure, "1 attempt,"));
  REQUIRE(says(failure, "starting the firmware: it was sent whole, but does not answer"));
}

TEST_CASE("A transfer that fails once costs one attempt") {
  ScriptedFalcon falcon(firmware_size);
  ScriptedLink link(falcon);
  link.failing_writes = 1;
  REQUIRE(upload_falcon_firmware(link, some_firmware(), false, no_back_off));
  REQUIRE(falcon.boots() == 2);
}

TEST_CASE("Unplugged at any transfer, the upload ends at once and says so") {
  std::size_t transfers = 0;
  {
    ScriptedFalcon falcon(firmware_size);
    ScriptedLink link(falcon);
    link.transfers_left = 1'000'000;
    REQUIRE(upload_falcon_firmware(link, some_firmware(), false, no_back_off));
    transfers = 1'000'000 - link.transfers_left;
  }
  REQUIRE(transfers > 200);
  for (std::size_t left = 0; left < transfers; ++left) {
    CAPTURE(left);
    ScriptedFalcon falcon(firmware_size);
    ScriptedLink link(falcon);
    link.transfers_left = left;
    const std::string failure =
        failure_of(upload_falcon_firmware(link, some_firmware(), false, no_back_off));
    REQUIRE(says(failure, "1 attempt,"));
    REQUIRE(says(failure, "unplugged"));
  }
}

TEST_CASE("Unplugged while it is asked for its firmware, it is an error") {
  ScriptedFalcon falcon(firmware_size, {}, true);
  ScriptedLink link(falcon);
  link.transfers_left = 0;
  REQUIRE_FALSE(set_falcon_normal_mode(link));
  const auto runs = falcon_firmware_runs(link, false);
  REQUIRE_FALSE(runs);
  REQUIRE(says(runs.error().message, "unplugged"));
}

TEST_CASE("An upload that is told to stop ends within a look, wherever it is") {
  for (const std::size_t at : {1U, 2U, 30U, 100U, 140U}) {
    CAPTURE(at);
    FalconFaults faults;
    faults.unanswered_calls = at < 30 ? -1 : 0;
    ScriptedFalcon falcon(firmware_size, faults);
    ScriptedLink link(falcon);
    std::atomic<bool> stop{false};
    link.stop = &stop;
    link.stop_at_read = at;
    REQUIRE_FALSE(upload_falcon_firmware(link, some_firmware(), stop, no_back_off));
    REQUIRE(link.reads <= at + 1);
  }
}

TEST_CASE("A firmware file is taken by its size and its first bytes, unknown or not") {
  const spm::test::TemporaryFolder folder;
  const auto write = [&folder](const std::vector<std::uint8_t>& bytes) {
    std::ofstream file(folder.file("firmware.bin"), std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    return folder.file("firmware.bin");
  };
  for (const std::size_t size : {4096, 8492, 16384}) {
    const auto bytes = some_firmware(size);
    const auto read = read_falcon_firmware(write(bytes));
    REQUIRE(read);
    REQUIRE(read->bytes == bytes);
    REQUIRE(read->sha256.size() == 64);
    REQUIRE_FALSE(read->known);
  }
  for (const std::size_t size : {2, 4095, 16385, 100000}) {
    const auto read = read_falcon_firmware(write(some_firmware(size)));
    REQUIRE_FALSE(read);
    REQUIRE(read.error().code == ExitCode::invalid_input);
    REQUIRE(says(read.error().message, "4096 to 16384"));
  }
  auto other = some_firmware();
  other[0] = 0x7F;
  const auto read = read_falcon_firmware(write(other));
  REQUIRE_FALSE(read);
  REQUIRE(read.error().code == ExitCode::invalid_input);
  REQUIRE(says(read.error().message, "7f 08"));
}

TEST_CASE("A firmware file that is not there, or is a folder, is exit code 2 with the cure") {
  const spm::test::TemporaryFolder folder;
  for (const std::string& path : {folder.file("none.bin"), std::string("/")}) {
    const auto read = read_falcon_firmware(path);
    REQUIRE_FALSE(read);
    REQUIRE(read.error().code == ExitCode::file_or_device);
    REQUIRE(says(read.error().message, "firmware=FILE"));
  }
}

}  // namespace falcon_firmware_test
