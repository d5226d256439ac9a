// SPDX-License-Identifier: Apache-2.0
// What the samples that touch push with. How they are found stands in object_look.cpp.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/across.hpp"
#include "common/base/octahedral.hpp"
#include "common/sixdof/object_contact.hpp"
#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

// Chosen with those of object_quadrature.cpp.

/// From its middle to a corner, over its side.
constexpr double corner_way = 0.7071067811865476;
/// Where less than so many patches of the level above the finest press, all finest squares are
/// divided, or divided twice; where twice as many do, none are.
constexpr std::array<double, 2> few_patches{4, 1};

}  // namespace

void ObjectContact::start_over() noexcept {
  patches_.clear();
  touches_.clear();
  for (Pair& pair : pairs_) {
    if (pair.sum.contacts == 0) continue;
    pair.sum = pair.grip_sum = {};
    pair.gripped = pair.pressed = 0;
  }
}

/// The same of one object, whose patches and touches begin at these numbers.
void ObjectContact::start_over(Pair& pair, std::size_t patches, std::size_t touches) noexcept {
  patches_.erase(patches_.begin() + static_cast<std::ptrdiff_t>(patches), patches_.end());
  touches_.erase(touches_.begin() + static_cast<std::ptrdiff_t>(touches), touches_.end());
  pair.sum = pair.grip_sum = {};
  pair.gripped = pair.pressed = 0;
}

PressedPatch& ObjectContact::other_patch_of(std::uint32_t object, std::uint32_t cluster) noexcept {
  std::uint8_t& at = patch_at_[first_way(pairs_[object]) + cluster];
  if (at < patches_.size() && patches_[at].object == object && patches_[at].cluster == cluster) {
    return patches_[at];
  }
  if (patches_.size() < patches_.capacity()) {
    at = static_cast<std::uint8_t>(patches_.size());
    PressedPatch& patch = patches_.emplace_back();
    patch.object = object;
    patch.cluster = cluster;
  }
  return patches_.back();
}

/// Adds a spring, N/m, of a part of a sample.
void ObjectContact::press_part(const Active& active, double spring, const CoarsePress& press,
                               const Vector3& normal, const Vector3& lever) noexcept {
  pairs_[active.object].sum.add(spring, press.depth, press.square, press.share, normal, lever);
  add(patch_of(active.object, active.cluster), spring * press.depth, press.depth, normal, normal,
      lever);
}

/// Adds the spring of a sample above the finest: of the part of its patch that is below, or as a
/// point.
void ObjectContact::press_coarse(Active& active, ObjectContactReport& report) noexcept {
  Pair& pair = pairs_[active.object];
  if (!active.known()) {
    // It was not needed to get to those below it.
    const Vector3 place = place_of(pair, active.sample);
    Vector3 found;
    active.distance = static_cast<float>(ask(pair, place, found, report));
    active.normal = floats_of(found);
  }
  if (!active.has_normal()) return;
  const Vector3 normal = vector_of(active.normal);
  if (as_points_) {
    return press_by(active.sample, active.object, active.cluster, place_of(pair, active.sample),
                    static_cast<double>(active.distance), normal);
  }
  near_known_ = false;
  const SampleShare& share = tool_.shares[active.sample];
  const SampleSpread& spread = tool_.spreads[active.sample];
  const Vector3 middle = turned(pair.pose.linear(), spread.middle);
  const double cosine = normal.dot(pair.pose.linear() * share.normal());
  const double half =
      static_cast<double>(spread.spread) * std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const CoarsePress press =
      coarse_press(-static_cast<double>(active.distance) - normal.dot(middle), half);
  if (!(press.depth > 0)) return;
  const Vector3 arm = turned(pair.pose.linear(), tool_.places[active.sample].position) + middle;
  const double spring = pair.stiffness * std::max(static_cast<double>(share.area), pair.least_area);
  press_part(active, spring, press, normal, arm);
  if (!pair.grip.on()) return;
  hold(active.sample, active.object, normal, spring * press.depth, spring * press.share,
       patch_of(active.object, active.cluster));
}

/// Adds the spring of a finest sample at `place` (object's frame).
void ObjectContact::press_finest(std::uint32_t sample, std::uint32_t object, std::uint32_t cluster,
                                 const Vector3& place, double distance,
                                 const Vector3& normal) noexcept {
  Pair& pair = pairs_[object];
  const Vector3 arm = place - pair.pose.translation();
  const double spring =
      pair.stiffness * std::max(static_cast<double>(tool_.shares[sample].area), pair.least_area);
  double depth = -distance;
  Vector3 along = normal;
  if (pair.lift > 0) {
    // The energy is that of the depth under the raised surface.
    const TextureHeight texture = texture_at(pair.texture, place);
    depth += texture.height;
    if (!(depth > 0)) return;
    along = normal - (texture.gradient - normal.dot(texture.gradient) * normal);
  }
  pair.sum.add(spring, depth, depth * depth, 1, along, arm);
  PressedPatch& patch = patch_of(object, cluster);
  add(patch, spring * depth, depth, along, normal, arm);
  if (pair.grip.on()) hold(sample, object, normal, spring * depth, spring, patch);
}

/// Adds the bristle of a sample that touches, and notes it. `force`: N, and `spring`: N/m, of the
/// sample's own.
void ObjectContact::hold(std::uint32_t sample, std::uint32_t object, const Vector3& normal,
                         double force, double spring, PressedPatch& patch) noexcept {
  Pair& pair = pairs_[object];
  pair.pressed += force;
  const Touch touch{sample,
                    object,
                    floats_of(normal),
                    static_cast<float>(force),
                    static_cast<float>(pair.grip.spring * spring),
                    static_cast<std::uint32_t>(&patch - patches_.data())};
  if (touches_.size() < touches_.capacity()) touches_.push_back(touch);
  pull_by(touch, pair.pose, patch);
}

/// Adds the bristle of a sample, with the tool at a pose in its object's frame.
void ObjectContact::pull_by(const Touch& touch, const Eigen::Isometry3d& pose,
                            PressedPatch& patch) noexcept {
  Pair& pair = pairs_[touch.object];
  if (!pair.in_grip) return;
  const auto& position = tool_.places[touch.sample].position;
  const Vector3 place = turned(pose.linear(), position) + pose.translation();
  const Vector3 before = turned(pair.settled.linear(), position) + pair.settled.translation();
  const Vector3 normal(touch.normal[0], touch.normal[1], touch.normal[2]);
  const auto spring = static_cast<double>(touch.spring);
  const Bristle bristle = grip_.bristle(touch.sample, touch.object, place, before, normal,
                                        is_finest(touch.sample) ? 0 : spring);
  if (!(bristle.most > 0)) return;
  const double stretch = bristle.stretch.norm();
  const bool gives_way = spring * stretch > bristle.most;
  const double secant = gives_way ? bristle.most / stretch : spring;
  const double energy = gives_way ? bristle.most * (stretch - bristle.most / spring / 2)
                                  : spring * stretch * stretch / 2;
  const Vector3 arm = place - pose.translation();
  pair.grip_sum.add_along(secant, -bristle.stretch, normal, arm, energy, gives_way);
  pair.gripped += bristle.most;
  const Vector3 pull = -secant * bristle.stretch;
  patch.grip += pull;
  patch.grip_torque += arm.cross(pull);
}

void ObjectContact::keep() noexcept {
  std::swap(patches_, kept_);
  std::swap(touches_, kept_touches_);
  std::swap(contacts_, kept_contacts_);
  kept_near_known_ = near_known_;
  for (Pair& pair : pairs_) {
    pair.kept = pair.pose;
    pair.kept_pressed = pair.pressed;
    if (pair.sum.contacts > 0 || pair.kept_sum.contacts > 0) pair.kept_sum = pair.sum;
  }
}

void ObjectContact::settle() noexcept {
  grip_.begin();
  for (std::uint32_t i = 0; i < pairs_.size(); ++i) {
    if (pairs_[i].present) grip_.begin(i);
  }
  for (const Touch& touch : kept_touches_) {
    const Pair& pair = pairs_[touch.object];
    const auto& position = tool_.places[touch.sample].position;
    const Vector3 place = turned(pair.kept.linear(), position) + pair.kept.translation();
    const Vector3 before =
        pair.in_grip ? Vector3(turned(pair.settled.linear(), position) + pair.settled.translation())
                     : place;
    const Vector3 normal(touch.normal[0], touch.normal[1], touch.normal[2]);
    grip_.settle(pair.grip, touch.sample, touch.object, place, before, normal,
                 static_cast<double>(touch.force), static_cast<double>(touch.spring));
  }
  for (std::uint32_t i = 0; i < pairs_.size(); ++i) {
    Pair& pair = pairs_[i];
    if (!pair.present) {
      // Objects of another method are settled in turn.
      if (++pair.absent > 1) pair.in_grip = false;
      continue;
    }
    pair.absent = 0;
    grip_.end(i, pair.kept_pressed);
    pair.settled = pair.kept;
    pair.in_grip = pair.placed;
  }
}

bool ObjectContact::grip_anew(ContactSum& sum) noexcept {
  if (kept_touches_.size() == kept_touches_.capacity()) return false;
  for (Pair& pair : pairs_) {
    pair.grip_sum = {};
    pair.gripped = 0;
  }
  for (PressedPatch& patch : kept_) patch.grip = patch.grip_torque = Vector3::Zero();
  for (const Touch& touch : kept_touches_) {
    pull_by(touch, pairs_[touch.object].kept, kept_[touch.patch]);
  }
  sum = {};
  for (Pair& pair : pairs_) add_up(pair, pair.kept_sum, sum);
  for (PressedPatch& patch : kept_) tell(patch);
  return true;
}

/// Adds what an object pushes and holds the tool with to a sum of the world's axes.
void ObjectContact::add_up(Pair& pair, const ContactSum& springs, ContactSum& all) const noexcept {
  if (springs.contacts == 0) return;
  ContactSum sum = springs;
  // Samples that carry the tool in turn each know the whole of its weight: together they hold no
  // more than it.
  if (pair.gripped > 0) {
    const double most = grip_.most(static_cast<std::uint32_t>(&pair - pairs_.data()));
    pair.gripped = std::min(1.0, most / pair.gripped);
    sum.wrench += pair.gripped * pair.grip_sum.wrench;
    sum.stiffness += pair.gripped * pair.grip_sum.stiffness;
    sum.energy += pair.gripped * pair.grip_sum.energy;
  }
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = pair.axes;
  // A torque is turned the other way round where the frame is mirrored.
  turn.bottomRightCorner<3, 3>() = pair.side * pair.axes;
  const Matrix6 whole = sum.stiffness.selfadjointView<Eigen::Lower>();
  all.wrench += turn * sum.wrench;
  all.stiffness += turn * whole * turn.transpose();
  all.energy += sum.energy;
  all.deepest = std::max(all.deepest, sum.deepest);
  all.contacts += sum.contacts;
}

/// Force and torque of a patch, the world's axes.
void ObjectContact::tell(PressedPatch& patch) const noexcept {
  const Pair& pair = pairs_[patch.object];
  patch.force = pair.axes * (patch.springs + pair.gripped * patch.grip);
  patch.torque =
      pair.side * (pair.axes * (patch.springs_torque + pair.gripped * patch.grip_torque));
}

/// Turns what was summed in the objects' axes to the world's.
void ObjectContact::sum_up(ContactSum& all) noexcept {
  for (Pair& pair : pairs_) add_up(pair, pair.sum, all);
  for (PressedPatch& patch : patches_) {
    tell(patch);
    const Eigen::Matrix3d& turn = pairs_[patch.object].axes;
    patch.moment = turn * patch.moment;
    patch.pressure = turn * patch.pressure;
  }
}

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
  if (!active.exact()) return;
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
