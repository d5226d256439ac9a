// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/field_memory.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace spm {

namespace {

/// Where normals differ by more than this sine, the plane counts as wrong.
constexpr double turned_sine = 0.07;
/// A reading this many validity radii away says nothing about how flat the field is.
constexpr double judged_radii = 3;
constexpr double first_share = 0.5, min_share = 0.125, growth = 1.5;

}  // namespace

FieldMemory::FieldMemory(const Settings& settings)
    : settings_(settings),
      entries_(settings.max_validity_radius > 0 ? std::bit_ceil(std::max(settings.points, 1U))
                                                : 0) {}

const FieldReading& FieldMemory::recall(std::uint32_t point) const noexcept {
  if (entries_.empty()) return nothing_;
  const FieldReading& kept = entries_[point & (entries_.size() - 1)].reading;
  return kept.point == point ? kept : nothing_;
}

void FieldMemory::learn(std::uint32_t point, FieldReading& reading) noexcept {
  double validity_radius =
      reading.normal.isZero() ? 0 : first_share * settings_.max_validity_radius;
  reading.validity_radius = static_cast<float>(validity_radius);
  reading.point = point;
  if (entries_.empty()) return;
  FieldReading& old = entries_[point & (entries_.size() - 1)].reading;
  const auto before = static_cast<double>(old.validity_radius);
  if (old.point == point && !old.normal.isZero() && !reading.normal.isZero() && before > 0 &&
      (reading.place - old.place).norm() < judged_radii * before) {
    const bool off =
        std::abs(old.distance_at(reading.place) - reading.distance) > settings_.error ||
        old.normal.cross(reading.normal).norm() > turned_sine || old.normal.dot(reading.normal) < 0;
    validity_radius =
        std::clamp((off ? 0.5 : growth) * before, min_share * settings_.max_validity_radius,
                   settings_.max_validity_radius);
    reading.validity_radius = static_cast<float>(validity_radius);
  }
  old = reading;
}

void FieldMemory::forget() noexcept { std::fill(entries_.begin(), entries_.end(), Entry{}); }

}  // namespace spm
