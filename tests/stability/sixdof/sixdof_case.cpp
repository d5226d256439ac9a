// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_case.hpp"

#include <algorithm>
#include <stdexcept>

namespace spm::stability {

SixdofScript::SixdofScript(const SixdofCase& tried, double period, const Vector3& offset) {
  Part last;
  last.to = tried.start.translation() + offset;
  last.orientation = Eigen::Quaterniond(tried.start.linear());
  parts_.push_back(last);
  for (const SixdofLeg& leg : tried.hand) {
    Part part;
    part.begin = last.end;
    part.from = last.to;
    part.to = leg.to + offset;
    part.orientation = orientation_of(last.turn) * last.orientation;
    part.turn = turn_between(part.orientation, orientation_of(leg.turn));
    const double seconds = std::max(
        {(part.to - part.from).norm() / leg.speed, part.turn.norm() / leg.turn_speed, period});
    part.end = part.begin + seconds;
    parts_.push_back(part);
    last = part;
    last.end += leg.rest;
  }
}

SixdofTarget SixdofScript::at(double time) const {
  const auto next = std::find_if(parts_.begin() + 1, parts_.end(),
                                 [time](const Part& part) { return part.begin > time; });
  const Part& part = *(next - 1);
  SixdofTarget target;
  if (time >= part.end) {
    target.position = part.to;
    target.orientation = orientation_of(part.turn) * part.orientation;
    return target;
  }
  const double seconds = part.end - part.begin;
  const double share = (time - part.begin) / seconds;
  target.position = part.from + share * (part.to - part.from);
  target.orientation = orientation_of(share * part.turn) * part.orientation;
  target.velocity = (part.to - part.from) / seconds;
  target.angular_velocity = part.turn / seconds;
  return target;
}

Eigen::Isometry3d pose_of(const Vector3& place, const Vector3& turn) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = place;
  pose.linear() = orientation_of(turn).toRotationMatrix();
  return pose;
}

SixdofCase sixdof_case(const std::string& name) {
  for (SixdofCase& tried : sixdof_catalogue()) {
    if (tried.name == name) return std::move(tried);
  }
  throw std::out_of_range("no case of that name: " + name);
}

}  // namespace spm::stability
