// SPDX-License-Identifier: Apache-2.0
// The finest samples as small squares, where ObjectContact refines by levels.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/across.hpp"
#include "common/base/octahedral.hpp"
#include "common/sixdof/object_contact.hpp"

namespace spm {

namespace {

// Chosen with those of object_quadrature.cpp.

/// From its middle to a corner, over its side.
constexpr double corner_way = 0.7071067811865476;
/// Where less than so many patches of the level above the finest press, all finest squares are
/// divided, or divided twice; where twice as many do, none are.
constexpr std::array<double, 2> few_patches{4, 1};

}  // namespace

/// Adds the spring of a square, or a part of it.
void ObjectContact::press_square(const Active& active, const Square& square,
                                 double weight) noexcept {
  if (!(square.distance < square_half * square.side)) return;
  const Vector3& along = square.normal;
  const double sine =
      sine_between(along[0], along[1], along[2], tool_.shares[active.sample].packed_normal);
  const CoarsePress press = coarse_press(-square.distance, square_half * square.side * sine);
  if (!(press.depth > 0)) return;
  const double spring = weight * pairs_[active.object].stiffness * square.side * square.side;
  press_part(active, spring, press, along, square.middle);
}

/// Presses a square as four smaller ones, whose distances are asked for. `divided`: how much of
/// these is divided again, and so on.
void ObjectContact::divide(const Active& active, const Square& square, double weight,
                           std::span<const double> divided, ObjectContactReport& report) noexcept {
  // All of it is deep, or clear: as one, it tells the same.
  if (std::abs(square.distance) > corner_way * square.side) {
    return press_square(active, square, weight);
  }
  Pair& pair = pairs_[active.object];
  const Eigen::Matrix3d& turn = pair.pose.linear();
  const double off = square.side / 4, again = divided.empty() ? 0 : divided.front();
  for (int k = 0; k < 4; ++k) {
    Square part = square;
    part.side = square.side / 2;
    part.middle +=
        ((k & 1) != 0 ? off : -off) * square.first + ((k & 2) != 0 ? off : -off) * square.second;
    Vector3 place;
    const QueriedDistance found =
        query_at(pair, {part.middle[0], part.middle[1], part.middle[2]}, place, report);
    if (!found.known()) continue;
    part.distance = pair.scale * found.distance;
    if (part.distance < square_half * part.side) {
      part.normal = turn.transpose() * pair.cursor.normal();
    }
    if (again < 1) press_square(active, part, weight * (1 - again));
    if (again > 0) divide(active, part, weight * again, divided.subspan(1), report);
  }
}

/// Presses a finest sample: as one square where many touch, as smaller ones where few do.
void ObjectContact::press_finest_square(const Active& active,
                                        ObjectContactReport& report) noexcept {
  if (!active.exact) return;
  const Pair& pair = pairs_[active.object];
  Square square;
  square.middle = vector_of(tool_.places[active.sample].position);
  square.side = std::sqrt(static_cast<double>(tool_.shares[active.sample].area));
  square.distance = static_cast<double>(active.distance);
  square.normal = vector_of(active.normal);
  std::array<double, few_patches.size()> divided{};
  for (std::size_t k = 0; k < divided.size(); ++k) {
    divided[k] = std::clamp(2 - pair.sum_before.contacts / few_patches[k], 0.0, 1.0);
  }
  const auto weight = static_cast<double>(active.weight);
  if (divided[0] < 1) press_square(active, square, weight * (1 - divided[0]));
  if (!(divided[0] > 0)) return;
  const Vector3 normal = tool_.shares[active.sample].normal();
  square.first = across(normal);
  square.second = normal.cross(square.first);
  divide(active, square, weight * divided[0], std::span(divided).subspan(1), report);
}

}  // namespace spm
