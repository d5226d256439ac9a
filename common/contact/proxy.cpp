// SPDX-License-Identifier: Apache-2.0
#include "common/contact/proxy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/contact/nearest_in_planes.hpp"
#include "common/query/query.hpp"

namespace spm {

namespace {

/// A proxy that would move less than this has arrived, m: half a thousandth of a newton at 1 N/mm.
constexpr double settled = 5e-7;
/// How deep a place may be and still count as outside, m: the rounding of a query.
constexpr double on_surface = 2e-7;
/// A step that ends inside by no more than this part of its length follows a curved wall, and is
/// lifted. One that ends deeper met another wall.
constexpr double lifted_share = 0.5;
/// Where answers meet, distances may jump by so many tolerances, which is no other wall.
constexpr double jump_share = 2;
/// A step that ends inside, where the nearest way out leads on by more than this part of the step's
/// length, has passed the middle of a thin wall, and would be lifted out on its far side.
constexpr double led_on_share = 0.5;
/// Largest number of lifts. Close to a surface whose error is the tolerance, places outside may be
/// reported as inside: with 4 lifts a proxy stays behind on flat teeth in 29 % of a slide's ticks,
/// with 6 in none.
constexpr int max_lifts = 8;
/// How often a step that ends inside is tried again, each time an eighth as long.
constexpr int max_shorter = 2;

/// A place, and the surface as the proxy sees it from there.
struct Place {
  Vector3 at = Vector3::Zero();
  double clearance = 0;  ///< m from the probe's surface to the object's, negative inside
  Vector3 normal = Vector3::Zero();

  [[nodiscard]] bool outside() const noexcept { return clearance >= -on_surface; }
  [[nodiscard]] HalfSpace half_space() const noexcept {
    return half_space_above(normal, normal.dot(at) - clearance);
  }
};

class Mover {
 public:
  /// `travel`: the distance that the proxy may move, m.
  Mover(const AssetView& asset, double radius, const Vector3& target, double travel) noexcept
      : asset_(asset), radius_(radius), target_(target), travel_(travel) {}

  [[nodiscard]] std::uint32_t queries() const noexcept { return queries_; }

  [[nodiscard]] Place ask(const Vector3& at) noexcept {
    ++queries_;
    const Answer answer = query_point(asset_, at);
    Place place{at, 0, answer.normal};
    switch (answer.status) {
      case Status::exact:
      case Status::deep:
        place.clearance = answer.distance - radius_;
        break;
      case Status::far:
        place.clearance = std::max(asset_.band.margin - radius_, 0.0);
        break;
      case Status::pruned:
        break;
    }
    return place;
  }

  /// Moves a place straight out of the surface until it is outside; false where that fails.
  bool lift(Place& place) noexcept {
    for (int k = 0; k < max_lifts && !place.outside(); ++k) {
      place = ask(place.at - place.clearance * place.normal);
    }
    return place.outside();
  }

  /// Moves from a place outside as far as possible with `most` queries. `held` says whether the
  /// surface holds it there.
  Place go(Place place, std::uint32_t most) noexcept {
    std::uint32_t touching = 0;
    while (queries_ < most && touching < proxy_touching_queries) {
      const std::uint32_t before = queries_;
      const Vector3 from = place.at;
      if (!step(place)) break;
      travel_ -= (place.at - from).norm();
      if (place.clearance <= proxy_blind_step) touching += queries_ - before;
    }
    return place;
  }

  bool held = false;

 private:
  const AssetView& asset_;
  double radius_;
  Vector3 target_;
  double travel_;
  std::uint32_t queries_ = 0;

  [[nodiscard]] double left(const Vector3& at) const noexcept { return (target_ - at).norm(); }

  /// One step towards the target; false where no step is left to take.
  bool step(Place& place) noexcept {
    held = false;
    if (left(place.at) < settled) return false;
    HalfSpaces walls;
    if (!place.normal.isZero()) walls.add(place.half_space());
    double longest = std::min(std::max(place.clearance, proxy_blind_step), travel_);
    for (int tries = 0; tries <= max_shorter;) {
      const Vector3 goal = nearest_in_planes(walls, target_);
      const Vector3 way = goal - place.at;
      const double length = way.norm();
      held = (goal - target_).norm() > settled;
      if (length < settled || longest < settled) return false;
      const Place next = ask(place.at + std::min(1.0, longest / length) * way);
      const bool past_middle = is_past_middle(place, next);
      if (!past_middle && take(place, next)) return true;
      held = true;
      if (!next.outside() && !past_middle && walls.add(next.half_space())) continue;
      // A place that three walls leave free is not certain to be free, because the surface is not
      // made of three planes.
      walls.count = 1;
      longest /= 8;
      ++tries;
    }
    return false;
  }

  /// Whether a step from outside ends beyond the middle of a wall.
  [[nodiscard]] static bool is_past_middle(const Place& from, const Place& to) noexcept {
    const Vector3 way = to.at - from.at;
    return !to.outside() && to.normal.dot(way) > led_on_share * way.norm();
  }

  /// Takes a step if it ends outside and nearer to the target, lifted out of a wall that it
  /// follows; or where a jump of answers lifts it, if that wall leads on and nearer.
  bool take(Place& place, Place next) noexcept {
    const Vector3 way = next.at - place.at;
    const double deep = -next.clearance, jump = jump_share * asset_.tolerance;
    if (!next.outside() && (deep > std::max(lifted_share * way.norm(), jump) || !lift(next))) {
      return false;
    }
    const double nearer = left(place.at) - settled / 4;
    if (!(left(next.at) < nearer)) {
      if (!(deep > on_surface && deep <= jump)) return false;
      HalfSpaces wall;
      wall.add(next.half_space());
      const Vector3 goal = nearest_in_planes(wall, target_);
      if (!(left(goal) < nearer && (goal - next.at).dot(way) > 0)) return false;
    }
    place = next;
    return true;
  }
};

}  // namespace

ProxyContact move_proxy(const AssetView& asset, double radius, const Vector3& point,
                        ProxyState& state, std::uint32_t most) noexcept {
  ProxyContact contact;
  contact.proxy = point;
  if (!point.allFinite()) {
    state = {};
    return contact;
  }
  const double travel = state.known && state.touching
                            ? proxy_catch_up + proxy_catch_up_share * (point - state.hand).norm()
                            : std::numeric_limits<double>::infinity();
  Mover mover(asset, radius, point, travel);
  Place place = mover.ask(state.known ? state.position : point);
  if (!mover.lift(place)) {
    // The surface is not near the proxy's last position any more: start again.
    place = mover.ask(point);
    if (!mover.lift(place)) {
      state = {};
      return contact;
    }
  }
  place = mover.go(place, most);
  const double depth = (place.at - point).norm();
  const bool touching = (mover.held || state.touching) && depth > settled;
  state = {true, place.at, point, touching};
  contact.proxy = place.at;
  contact.queries = mover.queries();
  if (!touching) return contact;
  contact.contact = true;
  contact.depth = depth;
  contact.normal = (place.at - point) / depth;
  return contact;
}

}  // namespace spm
