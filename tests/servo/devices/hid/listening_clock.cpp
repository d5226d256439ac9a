// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/devices/hid/listening_clock.hpp"

namespace spm::test {

namespace {

constexpr guint interval_ms = 2;
constexpr std::int64_t deaf_from_ns = 8'000'000;

std::int64_t monotonic_ns() { return std::int64_t{g_get_monotonic_time()} * 1000; }

}  // namespace

ListeningClock::~ListeningClock() {
  if (source_ == nullptr) return;
  g_source_destroy(source_);
  g_source_unref(source_);
}

void ListeningClock::begin() {
  const std::lock_guard lock(mutex_);
  GSource* calling = g_main_current_source();
  if (source_ != nullptr || calling == nullptr) return;
  listened_ns_ = monotonic_ns();
  source_ = g_timeout_source_new(interval_ms);
  g_source_set_callback(source_, &ListeningClock::on_time, this, nullptr);
  g_source_attach(source_, g_source_get_context(calling));
}

std::vector<std::array<std::int64_t, 2>> ListeningClock::deaf_ns() {
  const std::lock_guard lock(mutex_);
  return deaf_ns_;
}

gboolean ListeningClock::on_time(gpointer self) {
  auto* clock = static_cast<ListeningClock*>(self);
  const std::lock_guard lock(clock->mutex_);
  const std::int64_t now = monotonic_ns();
  if (now - clock->listened_ns_ >= deaf_from_ns) {
    clock->deaf_ns_.push_back({clock->listened_ns_, now});
  }
  clock->listened_ns_ = now;
  return G_SOURCE_CONTINUE;
}

}  // namespace spm::test
