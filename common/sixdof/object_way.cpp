// SPDX-License-Identifier: Apache-2.0
// How far the tool's samples have moved relative to an object, and which need not be looked at yet.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "common/sixdof/object_contact.hpp"
#include "common/sixdof/tool_motion.hpp"

namespace spm {

namespace {

/// Reduction of a clearance by the errors of two field values, in tolerances: at the sample that
/// was queried, and at the one that is not.
constexpr double doubtful_tolerances = 2;
/// m: what is kept of ways are floats, so they are counted anew from time to time.
constexpr double longest_way = 32;
/// Samples that wait to be looked at below a plane, at most.
constexpr std::size_t most_waiting = 256;
/// Samples whose height above a plane is told, at most: a few microseconds.
constexpr std::uint32_t most_heights = 2048;
/// m: a sample that is lower by less is not looked for.
constexpr double same_height = 1e-6;

/// Below the square of a finest sample's corners, by how much its tilt against a plane takes them,
/// m.
double tilted(const SampleShare& share, const Vector3& normal, double half) noexcept {
  const double cosine = normal.dot(share.normal());
  return half * std::sqrt(std::max(0.0, 1 - cosine * cosine));
}

}  // namespace

/// Takes up where an object is in this tick.
void ObjectContact::set_out(const ContactObject& object, Pair& pair,
                            const Eigen::Isometry3d& tool) noexcept {
  const Eigen::Isometry3d pose = object.pose.inverse(Eigen::Isometry) * tool;
  pair.to_world = object.pose.linear();
  pair.mirrored = pair.to_world.determinant() < 0;
  pair.axes = pair.to_world;
  pair.side = pair.mirrored ? -1 : 1;
  const double lift = object.texture.amplitude > 0 ? object.texture.amplitude : 0;
  const bool same =
      pair.placed && pair.field == object.field && pair.scale == object.scale && pair.lift == lift;
  // All as if it were new, or a tick would not be repeated to the bit.
  if (!same) {
    begin_travel(pair);
    pair.looked_at = pose;
    pair.cursor.begin(object.field);
    pair.listed = false;
    pair.clear = 0;
    pair.asleep = false;
  }
  pair.field = object.field;
  pair.scale = object.scale;
  pair.stiffness = object.stiffness > 0 ? object.stiffness : settings_.stiffness;
  pair.least_area = object.least_area;
  pair.doubt = doubtful_tolerances * object.scale * object.field->tolerance;
  pair.field_ends = object.scale * (object.field->band.margin + object.field->tolerance);
  pair.texture = object.texture;
  pair.lift = lift;
  pair.grip = object.grip;
  pair.pose = pose;
  pair.placed = pair.present = true;
  pair.since_all = ToolMotion(pair.looked_at, pose).of(tool_.centre, tool_.radius);
}

/// How far a pair may move on before a sample that is not listed touches, m; 0 or below: one may
/// touch. At most `most`, where any has been looked at.
double ObjectContact::left_of_list(const Pair& pair, double most) const noexcept {
  if (pair.asleep) return pair.clear - pair.since_all;
  const ToolMotion motion(pair.looked_at, pair.pose);
  const std::size_t first = first_way(pair);
  double left = most;
  for (std::uint32_t i = 0; i < clustered_; ++i) {
    const auto spare = static_cast<double>(spares_[first + i]);
    if (!(spare - pair.since_all >= left))
      left = std::min(left, spare - motion.of(tool_.places[i]));
  }
  return left;
}

/// How far all below a sample are from it at most, m, along a unit vector that has the part `along`
/// in the direction of its normal.
double ObjectContact::extent(std::uint32_t sample, double along) const noexcept {
  return extent(sample, along, std::sqrt(std::max(0.0, 1 - along * along)));
}

/// The same where the part across the normal is known too.
double ObjectContact::extent(std::uint32_t sample, double along, double across) const noexcept {
  constexpr double one = std::numeric_limits<std::uint16_t>::max();
  return static_cast<double>(tool_.places[sample].radius) *
         std::min(1.0, along * tool_.thicknesses[sample] / one + across);
}

/// How far all finest samples, which are squares where levels are settled, are above a support
/// plane of an object, m; below `enough` once one is found to be nearer than that.
double ObjectContact::parted_by(const Pair& pair, const SupportPlane& plane,
                                double enough) const noexcept {
  const Vector3 normal = pair.pose.linear().transpose() * plane.n;
  const double half = pair.settles ? tool_.levels.back().bound : 0;
  const double above = plane.n.dot(pair.pose.translation() - pair.scale * plane.x0);
  const auto height = [&](std::uint32_t sample) {
    const auto& at = tool_.places[sample].position;
    return above + normal.x() * double{at[0]} + normal.y() * double{at[1]} +
           normal.z() * double{at[2]};
  };
  double lowest = std::numeric_limits<double>::infinity();
  std::array<SampleChildren, most_waiting> waiting;
  std::size_t count = 0;
  waiting[count++] = {tool_.levels.front().first, tool_.levels.front().count};
  std::uint32_t heights = 0;
  while (count > 0) {
    const SampleChildren range = waiting[--count];
    heights += range.count;
    if (heights > most_heights) return 0;
    for (std::uint32_t sample = range.first; sample < range.first + range.count; ++sample) {
      const double own = height(sample);
      // The first below it is at the same place.
      if (own < enough) return own;
      if (is_finest(sample)) {
        lowest = std::min(lowest, own - tilted(tool_.shares[sample], normal, half));
        if (lowest < enough) return lowest;
      } else if (own - extent(sample, std::abs(normal.dot(tool_.shares[sample].normal()))) - half <
                 lowest - same_height) {
        if (count == waiting.size()) return 0;
        waiting[count++] = tool_.children[sample];
      }
    }
  }
  return lowest - same_height;
}

/// How far the plane that parts tool and object best holds them apart, m, of the object's support
/// planes and the sides of its box: section 2.1 of the paper, for all samples at once. 0 where none
/// does by more than what is listed.
double ObjectContact::parted(const Pair& pair) const noexcept {
  const AssetView& field = *pair.field;
  const double enough = pair.doubt + pair.lift + ahead_;
  const Vector3 centre = pair.pose * tool_.centre;
  const SupportPlane* best = nullptr;
  double most = enough;
  for (const SupportPlane& plane : field.planes) {
    const double outside = plane.n.dot(centre - pair.scale * plane.x0);
    if (!(outside > most)) continue;
    most = outside;
    best = &plane;
  }
  double apart = best != nullptr ? parted_by(pair, *best, enough) : 0;
  for (Eigen::Index axis = 0; axis < 3 && !(apart > enough); ++axis) {
    for (const double side : {-1.0, 1.0}) {
      SupportPlane plane;
      plane.n = side * Vector3::Unit(axis);
      plane.x0 = side < 0 ? field.box_low : field.box_high;
      if (plane.n.dot(centre - pair.scale * plane.x0) > enough) {
        apart = std::max(apart, parted_by(pair, plane, enough));
      }
    }
  }
  return apart > enough ? apart - pair.doubt - pair.lift : 0;
}

/// A look at all samples begins: counts the ways up to here. False where none can touch, or be
/// listed, yet.
bool ObjectContact::look_at_all(Pair& pair) noexcept {
  pair.asleep = pair.since_all + ahead_ < pair.clear;
  if (pair.asleep) {
    pair.spare = pair.clear - pair.since_all;
    return false;
  }
  const ToolMotion motion(pair.looked_at, pair.pose);
  const std::size_t first = first_way(pair);
  double longest = 0;
  const std::span<float> ways(spares_.data() + first, clustered_);
  motion.of_each(std::span(tool_.places).first(clustered_), ways);
  for (std::uint32_t i = 0; i < clustered_; ++i) {
    ways_[first + i] += static_cast<double>(ways[i]);
    longest = std::max(longest, ways_[first + i]);
  }
  pair.since = pair.since_all = 0;
  pair.looked_at = pair.pose;
  pair.spare = std::numeric_limits<double>::infinity();
  std::fill_n(spares_.begin() + static_cast<std::ptrdiff_t>(first), clustered_,
              std::numeric_limits<float>::infinity());
  if (!(longest < longest_way)) begin_travel(pair);
  const double apart = pair.presses ? 0 : parted(pair);
  pair.asleep = apart > ahead_;
  if (pair.asleep) pair.clear = pair.spare = apart;
  return !pair.asleep;
}

/// Forgets what is known of a pair's samples, and counts their ways from 0.
void ObjectContact::begin_travel(Pair& pair) noexcept {
  const auto which = &pair - pairs_.data();
  std::fill_n(until_.begin() + which * static_cast<std::ptrdiff_t>(coarse_), coarse_, 0.0F);
  std::fill_n(ways_.begin() + static_cast<std::ptrdiff_t>(first_way(pair)), clustered_, 0.0);
  begin_slot(pair);
}

void ObjectContact::begin_slot(const Pair& pair) noexcept {
  if (pair.slot < 0) return;
  const auto count = static_cast<std::ptrdiff_t>(tool_.levels.back().count);
  std::fill_n(finest_until_.begin() + pair.slot * count, count, 0.0F);
}

/// What is known of a pair's finest samples, by their numbers; null where there is no slot left.
float* ObjectContact::finest_until(std::uint32_t object) noexcept {
  Pair& pair = pairs_[object];
  for (std::size_t i = 0; pair.slot < 0 && i < slots_.size(); ++i) {
    std::int32_t& slot = slots_[i];
    if (slot >= 0) {
      Pair& owner = pairs_[static_cast<std::size_t>(slot)];
      if (owner.present) continue;
      owner.slot = -1;
    }
    slot = static_cast<std::int32_t>(object);
    pair.slot = static_cast<std::int32_t>(i);
    begin_slot(pair);
  }
  if (pair.slot < 0) return nullptr;
  const SampleLevel& finest = tool_.levels.back();
  return finest_until_.data() + static_cast<std::size_t>(pair.slot) * finest.count - finest.first;
}

}  // namespace spm
