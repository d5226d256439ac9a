// SPDX-License-Identifier: Apache-2.0
// Waiting for the loop's next tick. It costs the loop nothing: the waiting is the client's own.
#include <algorithm>
#include <cmath>

#include "servo/base/clock.hpp"
#include "servo/client/client.hpp"
#include "servo/client/state_reader.hpp"

namespace {

using namespace spm::servo;

constexpr double longest_wait = 1e6;  // s
/// How often a tick that is late is looked for.
constexpr std::int64_t look_ns = 100'000;
/// A tick is published when its devices were served, this long after it began at least.
constexpr std::int64_t service_ns = 20'000;
/// A daemon is only asked for where ticks stay away: that is a system call.
constexpr std::int64_t patience_ns = 10'000'000;

struct Published {
  std::uint64_t tick = 0;
  std::int64_t time_ns = 0;
};

}  // namespace

int spm_client_wait_tick(const spm_client* client, uint64_t after, double timeout,
                         spm_client_tick* tick) {
  if (client == nullptr || !(timeout >= 0 && timeout <= longest_wait)) {
    return SPM_CLIENT_BAD_ARGUMENT;
  }
  if (const int code = there(*client); code != SPM_CLIENT_OK) return code;
  const spm_shared_state& state = look(*client);
  const std::int64_t begun = now_ns(), deadline = begun + std::llround(timeout * 1e9);
  const std::int64_t period = std::llround(1e9 / state.rate_hz);
  std::int64_t asked = begun;
  while (true) {
    Published newest;
    const bool any = read_newest(state, [&](const spm_shared_snapshot& from) {
                       newest = {load_relaxed(from.tick), load_relaxed(from.time_ns)};
                       return true;
                     }) == ReadResult::fine;
    if (any && newest.tick > after) {
      return tick != nullptr ? spm_client_read_tick(client, tick) : SPM_CLIENT_OK;
    }
    const std::int64_t now = now_ns();
    if (load_acquire(state.ended) != 0) return SPM_CLIENT_NO_DAEMON;
    if (now - asked > patience_ns) {
      asked = now;
      // A call that waits is a sign of life too.
      static_cast<void>(look(*client));
      if (!client->connection().daemon_is_there()) return SPM_CLIENT_NO_DAEMON;
    }
    if (now >= deadline) return SPM_CLIENT_NOT_THERE;
    const std::int64_t due = any ? newest.time_ns + period + service_ns : 0;
    sleep_until(std::min(deadline, std::max(due, now + look_ns)));
  }
}
