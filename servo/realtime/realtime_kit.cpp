// SPDX-License-Identifier: Apache-2.0
#include "servo/realtime/realtime_kit.hpp"

#include <sys/resource.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>

namespace spm::servo {

namespace {

// Names and arguments as RealtimeKit's own interface description gives them.
constexpr const char* service = "org.freedesktop.RealtimeKit1";
constexpr const char* object = "/org/freedesktop/RealtimeKit1";
constexpr const char* interface = "org.freedesktop.RealtimeKit1";

/// Long enough for the bus to start the service.
constexpr std::uint64_t call_timeout_us = 2'000'000;

struct CloseBus {
  void operator()(sd_bus* bus) const noexcept { sd_bus_flush_close_unref(bus); }
};
using Bus = std::unique_ptr<sd_bus, CloseBus>;

/// The error of a call of the bus library.
class BusError {
 public:
  BusError() = default;
  BusError(const BusError&) = delete;
  BusError& operator=(const BusError&) = delete;
  ~BusError() { sd_bus_error_free(&error_); }

  [[nodiscard]] sd_bus_error* get() noexcept { return &error_; }
  [[nodiscard]] tl::unexpected<Error> refusal(int code) const {
    const char* const why = error_.message != nullptr ? error_.message : std::strerror(-code);
    return fail(ExitCode::realtime_refused, std::string("RealtimeKit gives none: ") + why);
  }

 private:
  sd_bus_error error_{};
};

/// A property whose D-Bus type is int32 (i) or int64 (x), according to `Number`.
template <class Number>
Result<Number> property(sd_bus* bus, const char* name) {
  static_assert(sizeof(Number) == 4 || sizeof(Number) == 8);
  BusError error;
  Number value = 0;
  const int code = sd_bus_get_property_trivial(bus, service, object, interface, name, error.get(),
                                               sizeof(Number) == 4 ? 'i' : 'x', &value);
  if (code < 0) return error.refusal(code);
  return value;
}

/// RealtimeKit helps only processes that the kernel ends if they compute for longer than `max_us`.
Result<void> limit_time(std::int64_t max_us) {
  const auto most = static_cast<rlim_t>(std::max<std::int64_t>(max_us, 1));
  rlimit limit{};
  if (getrlimit(RLIMIT_RTTIME, &limit) == 0) {
    limit = {std::min(limit.rlim_cur, most), std::min(limit.rlim_max, most)};
    if (setrlimit(RLIMIT_RTTIME, &limit) == 0) return {};
  }
  return fail(ExitCode::realtime_refused,
              std::string("RealtimeKit gives none without RLIMIT_RTTIME: ") + std::strerror(errno));
}

}  // namespace

Result<int> ask_realtime_kit(int below_most) {
  BusError error;
  sd_bus* opened = nullptr;
  int code = sd_bus_open_system(&opened);
  if (code < 0) return error.refusal(code);
  const Bus bus(opened);
  sd_bus_set_method_call_timeout(bus.get(), call_timeout_us);

  const auto most = property<std::int32_t>(bus.get(), "MaxRealtimePriority");
  if (!most) return tl::make_unexpected(most.error());
  const auto time = property<std::int64_t>(bus.get(), "RTTimeUSecMax");
  if (!time) return tl::make_unexpected(time.error());
  if (const auto limited = limit_time(*time); !limited) {
    return tl::make_unexpected(limited.error());
  }

  const int priority = std::max(1, *most - below_most);
  code = sd_bus_call_method(bus.get(), service, object, interface, "MakeThreadRealtimeWithPID",
                            error.get(), nullptr, "ttu", static_cast<std::uint64_t>(getpid()),
                            static_cast<std::uint64_t>(gettid()),
                            static_cast<std::uint32_t>(priority));
  if (code < 0) return error.refusal(code);
  return priority;
}

}  // namespace spm::servo
