// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/objects/hand_script.hpp"

namespace spm::stability {

HandScript::HandScript(const StabilityCase& tried, const Vector3& offset)
    : end_(tried.start + offset) {
  double time = 0;
  for (const HandLeg& leg : tried.hand) {
    const Vector3 to = leg.to + offset;
    const double arrival = time + (to - end_).norm() / leg.speed;
    if (arrival > time) segments_.push_back({time, arrival, end_, to});
    if (leg.rest > 0) segments_.push_back({arrival, arrival + leg.rest, to, to});
    time = arrival + (leg.rest > 0 ? leg.rest : 0);
    end_ = to;
  }
}

servo::HandTarget HandScript::at(double time) const noexcept {
  for (const Segment& segment : segments_) {
    if (time >= segment.to_time) continue;
    const double duration = segment.to_time - segment.from_time;
    const Vector3 velocity = (segment.to - segment.from) / duration;
    return {segment.from + (time - segment.from_time) * velocity, velocity};
  }
  return {end_, Vector3::Zero()};
}

}  // namespace spm::stability
