// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/objects/hand_script.hpp"

namespace spm::stability {

HandScript::HandScript(const StabilityCase& tried, const Vector3& offset)
    : end_(tried.start + offset) {
  double time = 0;
  for (const HandLeg& leg : tried.hand) {
    const Vector3 to = leg.to + offset;
    const double arrival = time + (to - end_).norm() / leg.speed;
    if (arrival > time) ways_.push_back({time, arrival, end_, to});
    if (leg.rest > 0) ways_.push_back({arrival, arrival + leg.rest, to, to});
    time = arrival + (leg.rest > 0 ? leg.rest : 0);
    end_ = to;
  }
}

servo::HandTarget HandScript::at(double time) const noexcept {
  for (const Way& way : ways_) {
    if (time >= way.to_time) continue;
    const double duration = way.to_time - way.from_time;
    const Vector3 velocity = (way.to - way.from) / duration;
    return {way.from + (time - way.from_time) * velocity, velocity};
  }
  return {end_, Vector3::Zero()};
}

}  // namespace spm::stability
