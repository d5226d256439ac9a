// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "common/base/vector.hpp"

namespace spm {

/// A field's answer at a point, and the radius around it in which its tangent plane may replace the
/// field.
struct FieldReading {
  Vector3 place = Vector3::Zero();    ///< the field's frame, m
  double distance = 0;                ///< signed, m; a lower bound where the normal is zero
  Vector3 normal = Vector3::Zero();   ///< unit, outward
  float validity_radius = -1;         ///< validity radius, m; below 0: nothing is known
  std::uint32_t point = 0xFFFFFFFFU;  ///< the point of a FieldMemory that it belongs to

  [[nodiscard]] bool known() const noexcept { return validity_radius >= 0; }
  [[nodiscard]] bool stands_for(const Vector3& at) const noexcept {
    const auto far = static_cast<double>(validity_radius);
    return (at - place).squaredNorm() <= far * far && known() && !normal.isZero();
  }
  [[nodiscard]] double distance_at(const Vector3& at) const noexcept {
    return distance + normal.dot(at - place);
  }
};

/// The latest readings of moving points, by the points' numbers, so that the field is queried again
/// only where a point has left the region in which the field is flat. Each point learns the size of
/// that region from its readings: where the remembered plane was off, the validity radius is
/// halved, otherwise it grows. Built at load time (allocates); everything else neither allocates
/// nor throws.
class FieldMemory {
 public:
  struct Settings {
    double max_validity_radius = 0;  ///< largest validity radius, m; 0: a reading is used again
                                     ///< only at exactly its own place
    double error = 1e-5;             ///< m, allowed error of a distance that is used again
    std::uint32_t points = 65536;    ///< number of points remembered at once, a power of two
  };

  explicit FieldMemory(const Settings& settings);

  /// The reading that is remembered of a point; `known` is false where there is none. Valid until
  /// the next `learn`.
  [[nodiscard]] const FieldReading& recall(std::uint32_t point) const noexcept;

  /// Remembers a new reading of a point, made at `reading.place`, and sets its validity radius.
  void learn(std::uint32_t point, FieldReading& reading) noexcept;

  void forget() noexcept;

 private:
  /// One cache line.
  struct alignas(64) Entry {
    FieldReading reading;
  };
  Settings settings_;
  std::vector<Entry> entries_;
  FieldReading nothing_;
};

}  // namespace spm
