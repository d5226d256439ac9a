// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/base/vector.hpp"

namespace spm {

/// A field's answer at a point, and the radius around it in which its tangent plane may replace the
/// field. In floats, since many are kept; rounding is far below a field's tolerance.
struct FieldReading {
  std::array<float, 3> place{};   ///< the field's frame, m
  float distance = 0;             ///< signed, m; a lower bound where the normal is zero
  std::array<float, 3> normal{};  ///< unit, outward
  float validity_radius = -1;     ///< validity radius, m; below 0: nothing is known

  [[nodiscard]] bool known() const noexcept { return validity_radius >= 0; }
  [[nodiscard]] bool has_normal() const noexcept {
    return normal[0] != 0 || normal[1] != 0 || normal[2] != 0;
  }
  /// From its place to another, m.
  [[nodiscard]] Vector3 to(const Vector3& at) const noexcept {
    return {at[0] - double{place[0]}, at[1] - double{place[1]}, at[2] - double{place[2]}};
  }
  [[nodiscard]] bool stands_for(const Vector3& at) const noexcept {
    const auto far = static_cast<double>(validity_radius);
    return far >= 0 && to(at).squaredNorm() <= far * far && has_normal();
  }
  [[nodiscard]] Vector3 outward() const noexcept {
    return {double{normal[0]}, double{normal[1]}, double{normal[2]}};
  }
  [[nodiscard]] double distance_at(const Vector3& at) const noexcept {
    return double{distance} + outward().dot(to(at));
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
  /// the next `learn`. Points whose numbers differ by less than the memory's room do not drive out
  /// one another.
  [[nodiscard]] const FieldReading& recall(std::uint32_t point) const noexcept {
    if (entries_.empty()) return nothing_;
    const Entry& kept = entries_[place_of(point)];
    return kept.point == point ? kept.reading : nothing_;
  }

  /// Remembers a new reading of a point, made at `reading.place`, and sets its validity radius.
  void learn(std::uint32_t point, FieldReading& reading) noexcept;

  void forget() noexcept;
  [[nodiscard]] std::size_t bytes() const noexcept { return entries_.capacity() * sizeof(Entry); }

 private:
  struct Entry {
    FieldReading reading;
    std::uint32_t point = 0xFFFFFFFFU;
  };
  [[nodiscard]] std::size_t place_of(std::uint32_t point) const noexcept {
    // The upper bits tell objects and their exchanges apart: they are spread over the table.
    constexpr std::uint32_t spread = 0x9E3779B1U;
    constexpr std::uint32_t sample_bits = 21;
    return (point + (point >> sample_bits) * spread) & (entries_.size() - 1);
  }
  Settings settings_;
  std::vector<Entry> entries_;
  FieldReading nothing_;
};

}  // namespace spm
