// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/object_contact.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "common/base/rigid_pose.hpp"
#include "common/query/query.hpp"

namespace spm {

namespace {

/// Reduction of a clearance by the errors of two field values, in tolerances: at the sample that
/// was queried, and at the one that is not.
constexpr double doubtful_tolerances = 2;
/// Number of samples that are skipped between two readings of the clock, where none of them queries
/// a field.
constexpr int passed_a_look = 16;
/// Ratio of the largest validity radius to the error that an answer may have when it is used again.
constexpr double reaches_an_error = 50;
/// A patch is not queried again before it has moved by this part of its radius. Until then the old
/// reading bounds its distance, and is used where no finer sample is reached.
constexpr double stale_share = 0.5;
/// Farther than any clearance, m.
constexpr double out_of_reach = 1e4;

std::int64_t steady_now() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// Element by element: a vector that is written this way and loaded in pairs would stall.
Vector3 turned(const Eigen::Matrix3d& by, const std::array<float, 3>& v) noexcept {
  return by.col(0) * double{v[0]} + by.col(1) * double{v[1]} + by.col(2) * double{v[2]};
}
double length(const std::array<float, 3>& v) noexcept {
  const double x = double{v[0]}, y = double{v[1]}, z = double{v[2]};
  return std::sqrt(x * x + y * y + z * z);
}

/// Depth of a patch whose parts are spread evenly between `depth - half` and `depth + half`: mean
/// and mean square over the part below the surface, and the size of that part.
struct Pressed {
  double depth = 0, square = 0, share = 0;
};
Pressed pressed(double depth, double half) noexcept {
  if (depth >= half) return {depth, depth * depth + half * half / 3, 1};
  if (!(depth > -half)) return {};
  const double below = depth + half;
  return {below * below / (4 * half), below * below * below / (6 * half), below / (2 * half)};
}

}  // namespace

class ObjectContact::Clock {
 public:
  Clock(const TickBudget& budget, double press_time) noexcept
      : now_(budget.now != nullptr ? budget.now : &steady_now),
        limited_(budget.nanoseconds > 0),
        press_time_(press_time) {
    if (!limited_) return;
    last_ = now_();
    end_ = last_ + budget.nanoseconds;
  }
  /// True where time is over. Also where it would run out if the next piece of work and the end of
  /// the tick each took as long as the longest so far, with this many samples still to be pressed.
  [[nodiscard]] bool over(const ObjectContactReport& report, std::size_t to_press) noexcept {
    if (!limited_) return false;
    if (report.asked == asked_ && ++passed_ < passed_a_look) return false;
    asked_ = report.asked;
    passed_ = 0;
    const std::int64_t now = now_();
    longest_ = std::max(longest_, now - last_);
    last_ = now;
    const auto pressing = static_cast<std::int64_t>(press_time_ * static_cast<double>(to_press));
    return now + 2 * longest_ + pressing >= end_;
  }
  /// Measures the time to press one sample, ns, from a batch that `press` presses; only large
  /// enough batches count.
  template <class Press>
  [[nodiscard]] double time_of(std::size_t samples, const Press& press) noexcept {
    constexpr std::size_t few = 32;
    if (!limited_ || samples < few) {
      press();
      return press_time_;
    }
    const std::int64_t begun = now_();
    press();
    const double taken = static_cast<double>(now_() - begun) / static_cast<double>(samples);
    return std::max(taken, press_time_ * forgotten_share);
  }

 private:
  /// The part of the longest press time that is kept from tick to tick.
  static constexpr double forgotten_share = 0.98;
  std::int64_t (*now_)() noexcept;
  bool limited_;
  double press_time_;  ///< ns per sample
  std::int64_t end_ = 0;
  std::int64_t last_ = 0;
  std::int64_t longest_ = 0;
  std::uint64_t asked_ = 0;
  int passed_ = 0;
};

ObjectContact::ObjectContact(const SurfaceSamples& tool, const ObjectContactSettings& settings)
    : tool_(tool),
      settings_(settings),
      pairs_(settings.objects),
      memories_(settings.objects, FieldMemory({settings.max_validity_radius,
                                               settings.max_validity_radius / reaches_an_error,
                                               settings.remembered})),
      until_(std::size_t{settings.objects} * tool.places.size(), 0.0) {
  active_.reserve(settings.max_active);
  next_.reserve(settings.max_active);
}

void ObjectContact::forget(std::uint32_t object) noexcept {
  if (object < pairs_.size()) pairs_[object].placed = false;
}

void ObjectContact::move(Pair& pair, const ContactObject& object,
                         const Eigen::Isometry3d& tool) noexcept {
  const Eigen::Isometry3d pose = object.pose.inverse(Eigen::Isometry) * tool;
  pair.to_world = object.pose.linear();
  if (!pair.placed || pair.field != object.field) {
    pair.travelled += out_of_reach;
    memories_[static_cast<std::size_t>(&pair - pairs_.data())].forget();
  } else {
    // A rotation by t moves a point at distance r from the axis by 2 r sin(t / 2).
    const double turn = (pose.linear() - pair.pose.linear()).norm() / std::sqrt(2.0);
    pair.travelled +=
        (pose * tool_.centre - pair.pose * tool_.centre).norm() + turn * tool_.radius * (1 + 1e-9);
  }
  pair.field = object.field;
  pair.pose = pose;
  pair.placed = true;
}

/// Queries the field at a sample's position.
FieldReading ObjectContact::read(std::uint32_t object, std::uint32_t sample, const Vector3& place,
                                 ObjectContactReport& report) noexcept {
  const AssetView& field = *pairs_[object].field;
  FieldReading reading;
  reading.place = place;
  ++report.asked;
  const Answer answer = query_point(field, place);
  if (answer.status == Status::exact || answer.status == Status::deep) {
    reading.distance = answer.distance;
    reading.normal = answer.normal;
  } else {
    reading.distance = clearance(field, place);
  }
  memories_[object].learn(sample, reading);
  return reading;
}

/// Adds a sample to `found` unless it, and everything below it, is clear of the object. `above`:
/// the reading for the sample above it.
void ObjectContact::look(std::uint32_t sample, std::uint32_t object, const FieldReading& above,
                         std::vector<Active>& found, ObjectContactReport& report) noexcept {
  const Pair& pair = pairs_[object];
  double& until = until_[std::size_t{object} * tool_.places.size() + sample];
  if (pair.travelled < std::abs(until)) {
    if (until > 0) report.clearance = std::min(report.clearance, until - pair.travelled);
    if (until < 0) found.push_back({sample, object, 0, {}});
    return;
  }
  until = 0;
  ++report.tested;
  const Vector3 place =
      turned(pair.pose.linear(), tool_.places[sample].position) + pair.pose.translation();
  const auto radius = static_cast<double>(tool_.places[sample].radius);
  const double doubt = doubtful_tolerances * pair.field->tolerance;
  const auto let_go = [&](double spare) {
    until = pair.travelled + spare;
    report.clearance = std::min(report.clearance, spare);
  };
  // By reference, and directly into its place: copying what was just written would stall.
  const FieldReading* reading = &above;
  FieldReading fresh;
  const auto add = [&](double distance) {
    Active& active = found.emplace_back();
    active.sample = sample;
    active.object = object;
    active.distance = distance;
    active.reading = *reading;
  };
  const bool same_place = above.known() && above.place == place;
  if (!same_place && !above.stands_for(place)) {
    reading = &memories_[object].recall(sample);
    if (reading->known() && !reading->stands_for(place)) {
      const double moved = (place - reading->place).norm();
      const double least = reading->distance - moved - doubt;
      if (least > radius) return let_go(least - radius);
      if (moved < stale_share * radius) {
        add(reading->distance_at(place));
        return;
      }
    }
    if (!reading->stands_for(place)) {
      // A field changes by at most the length of a step, so the reading for the sample above may be
      // enough.
      const double least = above.distance - (place - above.place).norm() - doubt;
      if (above.known() && least > radius) return let_go(least - radius);
      fresh = read(object, sample, place, report);
      reading = &fresh;
    }
  }
  const double distance = reading->distance_at(place);
  const double least = distance - doubt;
  if (least > radius) return let_go(least - radius);
  if (radius > 0) {
    // How near the surface must be for the sample itself to touch. A patch so large that it extends
    // far from its sample says little about the contact.
    const SampleShare& share = tool_.shares[sample];
    double own = least - length(share.middle) - static_cast<double>(share.spread);
    if (reading->normal.isZero()) own = std::max(own, distance / 4);
    if (own > 0) until = -(pair.travelled + own);
  } else {
    report.clearance = 0;
  }
  if (radius > 0 || distance < 0) add(distance);
}

/// Adds the spring of a sample that touches.
void ObjectContact::press(const Active& active, ContactSum& sum) const noexcept {
  const Vector3& normal = active.reading.normal;
  if (!active.reading.known() || normal.isZero()) return;
  const Pair& pair = pairs_[active.object];
  const SampleShare& share = tool_.shares[active.sample];
  Vector3 arm = turned(pair.pose.linear(), tool_.places[active.sample].position);
  Pressed press{-active.distance, active.distance * active.distance, 1};
  if (tool_.children[active.sample].count > 0) {
    const Vector3 middle = turned(pair.pose.linear(), share.middle);
    const double cosine = normal.dot(turned(pair.pose.linear(), share.normal));
    const double half =
        static_cast<double>(share.spread) * std::sqrt(std::max(0.0, 1 - cosine * cosine));
    press = pressed(-active.distance - normal.dot(middle), half);
    arm += middle;
  }
  if (!(press.depth > 0)) return;
  const double spring = settings_.stiffness * static_cast<double>(share.area);
  sum.add(spring, press.depth, press.square, press.share, pair.to_world * normal,
          pair.to_world * arm);
}

/// Replaces the active samples by those below them. False where time or room ran out: then `next_`
/// has the finer ones that were reached, and the active ones from `left_` on represent the rest.
bool ObjectContact::refine(std::uint32_t level, Clock& clock,
                           ObjectContactReport& report) noexcept {
  next_.clear();
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Active& parent = active_[i];
    const SampleChildren& below = tool_.children[parent.sample];
    const std::size_t before = next_.size();
    bool over = before + below.count > next_.capacity();
    for (std::uint32_t k = 0; k < below.count && !over; ++k) {
      over = clock.over(report, next_.size() + active_.size() - i);
      if (!over) look(below.first + k, parent.object, parent.reading, next_, report);
    }
    if (over) {
      // A sample is either replaced completely by those below it, or kept.
      next_.resize(before);
      left_ = i;
      report.refined = static_cast<double>(i) / static_cast<double>(active_.size());
      report.degraded = true;
      return false;
    }
  }
  report.level = level;
  std::swap(active_, next_);
  next_.clear();
  return true;
}

ObjectContactReport ObjectContact::tick(const Eigen::Isometry3d& tool_pose,
                                        std::span<const ContactObject> objects,
                                        const TickBudget& budget) noexcept {
  ObjectContactReport report;
  Clock clock(budget, press_time_);
  active_.clear();
  next_.clear();
  left_ = 0;
  if (tool_.levels.empty() || !keeps_lengths(tool_pose)) return report;
  const std::size_t count = std::min(objects.size(), pairs_.size());
  const SampleLevel& coarsest = tool_.levels.front();
  for (std::uint32_t object = 0; object < count; ++object) {
    if (objects[object].field == nullptr || !keeps_lengths(objects[object].pose)) continue;
    move(pairs_[object], objects[object], tool_pose);
    for (std::uint32_t k = 0; k < coarsest.count && active_.size() < active_.capacity(); ++k) {
      look(coarsest.first + k, object, {}, active_, report);
    }
  }
  const auto levels = static_cast<std::uint32_t>(tool_.levels.size());
  for (std::uint32_t level = 1; level < levels && level <= budget.finest_level; ++level) {
    if (active_.empty()) {
      // Nothing can touch, and that holds down to the finest level.
      report.level = levels - 1;
      break;
    }
    if (!refine(level, clock, report)) break;
  }
  const std::span<const Active> left = std::span(active_).subspan(left_);
  press_time_ = clock.time_of(next_.size() + left.size(), [&] {
    for (const Active& active : next_) press(active, report.sum);
    for (const Active& active : left) press(active, report.sum);
  });
  // Samples that were not resolved to the finest level may touch.
  if (report.degraded || report.level + 1 < levels) report.clearance = 0;
  const Matrix6 whole = report.sum.stiffness.selfadjointView<Eigen::Lower>();
  report.sum.stiffness = whole;
  return report;
}

}  // namespace spm
