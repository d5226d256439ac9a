// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/vector.hpp"

namespace spm {

/// What a field said at a place, and how far from it its tangent plane may stand for the field.
struct FieldReading {
  Vector3 place = Vector3::Zero();    ///< the field's frame, m
  double distance = 0;                ///< signed, m; a lower bound where the normal is zero
  Vector3 normal = Vector3::Zero();   ///< unit, outward
  float reach = -1;                   ///< m; below 0: nothing is known
  std::uint32_t point = 0xFFFFFFFFU;  ///< whose it is in a FieldMemory

  [[nodiscard]] bool known() const noexcept { return reach >= 0; }
  [[nodiscard]] bool stands_for(const Vector3& at) const noexcept {
    const auto far = static_cast<double>(reach);
    return (at - place).squaredNorm() <= far * far && known() && !normal.isZero();
  }
  [[nodiscard]] double distance_at(const Vector3& at) const noexcept {
    return distance + normal.dot(at - place);
  }
};

/// The latest readings of moving points, by their numbers, so that a point is asked again only
/// where it has moved farther than the field is flat. How far that is each point learns from what
/// it finds: where the plane that was remembered was off, it reaches half as far from then on, else
/// farther. Built at load time (allocates); the rest neither allocates nor throws.
class FieldMemory {
 public:
  struct Settings {
    double most_reach = 0;         ///< m; 0: nothing is used again but at the very place
    double error = 1e-5;           ///< m, that a distance may be off when it is used again
    std::uint32_t points = 65536;  ///< remembered at once, a power of two
  };

  explicit FieldMemory(const Settings& settings);

  /// What is remembered of a point; not known where that is nothing. Stays until the next `learn`.
  [[nodiscard]] const FieldReading& recall(std::uint32_t point) const noexcept;

  /// Remembers a reading of a point that was just made at `reading.place`, and gives it its reach.
  void learn(std::uint32_t point, FieldReading& reading) noexcept;

  void forget() noexcept;

 private:
  /// A line of the processor's memory.
  struct alignas(64) Entry {
    FieldReading reading;
  };
  Settings settings_;
  std::vector<Entry> entries_;
  FieldReading nothing_;
};

}  // namespace spm
