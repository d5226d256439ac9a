// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "servo/view/view_state.hpp"

namespace spm::servo {

namespace {

constexpr double seconds_per_ns = 1e-9;
constexpr double us_per_ns = 1e-3;

/// Appends numbers in order.
class Frame {
 public:
  void add(double value) { numbers_.push_back(value); }
  template <std::size_t Count>
  void add(const double (&values)[Count]) {
    numbers_.insert(numbers_.end(), std::begin(values), std::end(values));
  }
  /// Fills up a part that began at `from` to its length.
  void fill(std::size_t from, std::size_t length) { numbers_.resize(from + length, 0); }
  [[nodiscard]] std::size_t size() const noexcept { return numbers_.size(); }
  [[nodiscard]] std::vector<double> take() { return std::move(numbers_); }

 private:
  std::vector<double> numbers_;
};

/// The longest duration between two looks, us, at most a quarter too long.
double longest_us(const std::uint64_t (&before)[64], const std::uint64_t (&now)[64],
                  std::uint64_t longest) noexcept {
  for (std::uint32_t bucket = 64; bucket-- > 0;) {
    if (now[bucket] <= before[bucket]) continue;
    const std::uint64_t end = bucket < 63 ? spm_client_bucket_end(bucket) : longest;
    return static_cast<double>(std::min(end, longest)) * us_per_ns;
  }
  return 0;
}

void add_head(Frame& frame, const ViewState& state, const spm_client_loop& before) {
  const spm_client_loop& loop = state.loop;
  const bool known = loop.ticks >= before.ticks && loop.time_ns > before.time_ns;
  const double seconds = known ? double(loop.time_ns - before.time_ns) * seconds_per_ns : 0;
  frame.add(1);  // the version of this order
  frame.add(state.daemon);
  frame.add(double(state.tick.tick));
  frame.add(double(state.tick.time_ns) * seconds_per_ns);
  frame.add(state.age);
  frame.add(double(loop.ticks));
  frame.add(double(loop.missed));
  frame.add(double(loop.degraded));
  frame.add(seconds > 0 ? double(loop.ticks - before.ticks) / seconds : 0);
  frame.add(known ? longest_us(before.wake, loop.wake, loop.wake_max_ns) : 0);
  frame.add(known ? longest_us(before.busy, loop.busy, loop.busy_max_ns) : 0);
  frame.add(double(state.devices.size()));
  frame.add(double(state.objects.size()));
  frame.add(double(state.tick.object_total));
  frame.add(double(state.contacts.size()));
  frame.add(double(loop.refused));
  frame.fill(0, frame_head);
}

void add_device(Frame& frame, const ViewDevice& device) {
  const std::size_t from = frame.size();
  const spm_client_device& state = device.state;
  frame.add(state.connected);
  frame.add(state.position);
  frame.add(state.orientation);
  frame.add(state.velocity);
  frame.add(state.force);
  frame.add(state.torque);
  frame.add(state.depth);
  frame.add(state.contact);
  frame.add(state.buttons);
  frame.add(state.cause);
  frame.add(state.health);
  frame.add(state.proxy);
  frame.add(state.proxy_orientation);
  frame.add(state.force_cap);
  frame.add(state.torque_cap);
  frame.add(state.limits);
  frame.add(state.has_tool);
  frame.add(state.tool_position);
  frame.add(state.tool_orientation);
  frame.add(state.hand);
  frame.add(device.counts.energy);
  frame.add(device.counts.generated_max);
  frame.add(device.counts.force_max);
  frame.add(double(device.counts.cap_hits));
  frame.add(state.level);
  frame.add(state.cuts);
  frame.fill(from, frame_device);
}

void add_object(Frame& frame, const spm_client_object& object) {
  const std::size_t from = frame.size();
  frame.add(double(object.id));
  frame.add(object.asset);
  frame.add(object.position);
  frame.add(object.orientation);
  frame.add(object.scale);
  frame.add(object.force);
  frame.add(object.contact);
  frame.add(object.movable);
  frame.add(object.driven);
  frame.fill(from, frame_object);
}

void add_contact(Frame& frame, const spm_client_contact& contact) {
  const std::size_t from = frame.size();
  frame.add(contact.device);
  frame.add(double(contact.object));
  frame.add(contact.place);
  frame.add(contact.normal);
  frame.add(contact.force);
  frame.add(contact.depth);
  frame.fill(from, frame_contact);
}

}  // namespace

std::vector<double> frame_of(const ViewState& state, const spm_client_loop& before) {
  Frame frame;
  add_head(frame, state, before);
  for (const ViewDevice& device : state.devices) add_device(frame, device);
  for (const ViewObject& object : state.objects) add_object(frame, object.state);
  for (const spm_client_contact& contact : state.contacts) add_contact(frame, contact);
  return frame.take();
}

}  // namespace spm::servo
