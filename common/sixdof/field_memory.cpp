// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/field_memory.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/sixdof/sample_vectors.hpp"

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

void FieldMemory::learn(std::uint32_t point, FieldReading& reading) noexcept {
  const bool is_plane = reading.has_normal();
  double validity_radius = is_plane ? first_share * settings_.max_validity_radius : 0;
  reading.validity_radius = static_cast<float>(validity_radius);
  if (entries_.empty()) return;
  Entry& entry = entries_[place_of(point)];
  const FieldReading& old = entry.reading;
  const auto before = static_cast<double>(old.validity_radius);
  const Vector3 place = vector_of(reading.place);
  if (entry.point == point && is_plane && before > 0 && old.has_normal() &&
      old.to(place).norm() < judged_radii * before) {
    const Vector3 was = old.outward(), is = reading.outward();
    const bool off = std::abs(old.distance_at(place) - static_cast<double>(reading.distance)) >
                         settings_.error ||
                     was.cross(is).norm() > turned_sine || was.dot(is) < 0;
    validity_radius =
        std::clamp((off ? 0.5 : growth) * before, min_share * settings_.max_validity_radius,
                   settings_.max_validity_radius);
    reading.validity_radius = static_cast<float>(validity_radius);
  }
  entry.reading = reading;
  entry.point = point;
}

void FieldMemory::forget() noexcept { std::fill(entries_.begin(), entries_.end(), Entry{}); }

}  // namespace spm
