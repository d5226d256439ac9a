// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_foxglove.hpp"

#include <unistd.h>

#include <algorithm>
#include <utility>

namespace spm::servo {

namespace {

Vector3 vector(const double (&numbers)[3]) { return {numbers[0], numbers[1], numbers[2]}; }

Eigen::Quaterniond turn(const double (&numbers)[4]) {
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

}  // namespace

FoxgloveViewer::FoxgloveViewer(std::function<void()> wake) : wake_(std::move(wake)) {
  texts_.push_back(
      {false, FoxgloveClient::greeting("spm-servo view", static_cast<std::uint64_t>(getpid()))});
}

void FoxgloveViewer::give(const std::vector<FoxgloveChannel>& channels,
                          const std::vector<HandSample>& samples,
                          const std::vector<std::string>& causes_before) {
  const std::vector<std::string> offers = client_.offer(channels);
  if (!offers.empty()) messages_.clear();
  for (const std::string& text : offers) texts_.push_back({false, text});
  for (const auto& [subscription, id] : client_.subscriptions()) {
    const FoxgloveChannel& channel = *client_.channel(id);
    const HandSample& sample = samples[channel.device];
    const bool is_log = channel.stream == Stream::log;
    const std::string payload =
        is_log ? log_message(sample, causes_before[channel.device]) : message_of(channel, sample);
    if (payload.empty()) continue;
    std::string bytes = FoxgloveClient::message(subscription, sample.time_ns, payload);
    if (is_log) {
      texts_.push_back({true, std::move(bytes)});
    } else {
      messages_[subscription] = std::move(bytes);
    }
  }
  wake_();
}

void FoxgloveViewer::hear(const std::string& text) {
  std::string answer = client_.hear(text);
  if (!answer.empty()) texts_.push_back({false, std::move(answer)});
  wake_();
}

bool FoxgloveViewer::next(ViewPage::Message& message) {
  if (!texts_.empty()) {
    message = std::move(texts_.front());
    texts_.pop_front();
    return true;
  }
  if (messages_.empty()) return false;
  message = {true, std::move(messages_.begin()->second)};
  messages_.erase(messages_.begin());
  return true;
}

void FoxgloveDesk::leave(const FoxgloveViewer& viewer) {
  std::erase_if(viewers_, [&](const auto& other) { return other.get() == &viewer; });
}

void FoxgloveDesk::look(const ViewState& state) {
  if (state.devices.empty() || state.tick.tick == tick_) return;
  tick_ = state.tick.tick;
  const std::vector<HandSample> samples = samples_of(state);
  std::vector<bool> has_tool(samples.size());
  std::transform(samples.begin(), samples.end(), has_tool.begin(),
                 [](const HandSample& sample) { return sample.tool.has_value(); });
  if (has_tool != has_tool_) {
    has_tool_ = has_tool;
    channels_ = channels_of(has_tool);
  }
  causes_.resize(samples.size(), "none");
  const auto viewers = viewers_;
  for (const auto& viewer : viewers) viewer->give(channels_, samples, causes_);
  for (std::size_t i = 0; i < samples.size(); ++i) causes_[i] = samples[i].cause;
}

std::vector<HandSample> samples_of(const ViewState& state) {
  std::vector<HandSample> samples;
  for (const ViewDevice& device : state.devices) {
    const spm_client_device& now = device.state;
    HandSample sample;
    sample.tick = state.tick.tick;
    sample.time_ns = static_cast<std::uint64_t>(state.tick.time_ns);
    sample.hand = {vector(now.position), turn(now.orientation)};
    if (now.has_tool != 0)
      sample.tool = HandPose{vector(now.tool_position), turn(now.tool_orientation)};
    sample.held = vector(now.proxy);
    sample.sent = {vector(now.force), vector(now.torque)};
    sample.depth = now.depth;
    sample.contact = now.contact != 0;
    if (now.cause < state.causes.size()) {
      sample.cause = state.causes[now.cause].name;
      sample.cure = state.causes[now.cause].cure;
    }
    samples.push_back(std::move(sample));
  }
  return samples;
}

}  // namespace spm::servo
