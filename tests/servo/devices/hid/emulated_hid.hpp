// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace spm::test {

using HidBytes = std::vector<std::uint8_t>;

/// How a device shows itself on the bus.
struct HidIdentity {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string name;
  std::string serial;
  HidBytes descriptor;
};

/// The firmware of an emulated HID device. Its packets are written here by hand, from what public
/// firmware does, so that they check the daemon's codec and are not made by it.
class EmulatedHid {
 public:
  EmulatedHid() = default;
  EmulatedHid(const EmulatedHid&) = delete;
  EmulatedHid& operator=(const EmulatedHid&) = delete;
  virtual ~EmulatedHid() = default;

  [[nodiscard]] virtual HidIdentity identity() const = 0;
  /// ms between calls of `unasked`; 0: none.
  [[nodiscard]] virtual int period_ms() const = 0;
  /// The device got power.
  virtual std::vector<HidBytes> plug_in() = 0;
  /// Reports that it sends by itself now.
  virtual std::vector<HidBytes> unasked() = 0;
  /// Takes a report that the host wrote, report id first. Returns what the device sends in answer.
  virtual std::vector<HidBytes> written(const HidBytes& bytes) = 0;
  /// Called when the host took a report. Returns what the device sends next.
  virtual std::vector<HidBytes> taken() = 0;
  /// Takes a feature report that the host set, id first. Returns false if the device refuses it.
  virtual bool feature_written(const HidBytes& bytes) {
    static_cast<void>(bytes);
    return false;
  }
  /// The feature report, or the input report, with the id that the host asked for. Nothing if the
  /// device refuses that.
  virtual std::optional<HidBytes> feature_asked(std::uint8_t id) {
    static_cast<void>(id);
    return std::nullopt;
  }
  virtual std::optional<HidBytes> input_asked(std::uint8_t id) {
    static_cast<void>(id);
    return std::nullopt;
  }
  /// What it saw. `wrong` counts packets that its protocol does not know.
  [[nodiscard]] virtual nlohmann::ordered_json seen() const = 0;
  [[nodiscard]] virtual int wrong() const = 0;
};

struct EmulatedOptions {
  int press_at = -1;   ///< V2 and V3: the calibration button at this report; -1: never
  bool quiet = false;  ///< V2 and V3: its first report was lost, so that it waits to be asked
  std::array<int, 3> start{};  ///< counters A to C when it gets power
  int step = 0;                ///< counts that C steps to each side; 0: it swings
  int step_every = 1;          ///< reports between an answered step and the next, at least
};

/// A device by name: wooden-v1, wooden-v2, wooden-v3, spacemouse, or one of make_emulated_pid; or
/// null.
[[nodiscard]] std::unique_ptr<EmulatedHid> make_emulated_hid(std::string_view name,
                                                             const EmulatedOptions& options);

}  // namespace spm::test
