// SPDX-License-Identifier: Apache-2.0

// Measures how long libspm_client takes to read the state of a live daemon, and prints JSON: ns
// per read over batches of one read and of sixteen, timed by clock_gettime. The time of
// clock_gettime itself (the median of two calls in a row) is subtracted.
//
// Usage: client_reads SOCKET [READS]. Exits with code 2 and a message if no daemon answers.

#include <spm_client.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace {

constexpr std::size_t max_objects = 64;  // that a daemon reports
constexpr int clock_pairs = 100'000;

std::int64_t now_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// Percentile by the nearest rank; sorts `values`.
double percentile(std::vector<double>& values, double share) {
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

double clock_overhead() {
  std::vector<double> pairs(clock_pairs);
  for (double& pair : pairs) {
    const std::int64_t before = now_ns();
    pair = static_cast<double>(now_ns() - before);
  }
  return percentile(pairs, 0.5);
}

/// Times `read`, which gives a code of spm_client.h, in batches. A read that is refused as
/// busy still counts as a read.
template <class Read>
nlohmann::ordered_json measure(const char* what, int batch, int reads, double overhead,
                               const Read& read) {
  std::vector<double> times(static_cast<std::size_t>(std::max(1, reads / batch)));
  std::int64_t busy = 0;
  for (double& time : times) {
    const std::int64_t before = now_ns();
    for (int i = 0; i < batch; ++i) busy += read() == SPM_CLIENT_OK ? 0 : 1;
    time = std::max(0.0, static_cast<double>(now_ns() - before) - overhead) / batch;
  }
  const double p50 = percentile(times, 0.5), p99 = percentile(times, 0.99);
  return {{"what", what},
          {"batch", batch},
          {"reads", times.size() * static_cast<unsigned>(batch)},
          {"busy", busy},
          {"p50_ns", p50},
          {"p99_ns", p99},
          {"max_ns", times.back()}};
}

int run(spm_client* client, int reads) {
  spm_client_tick tick{};
  spm_client_device device{};
  std::array<spm_client_device, 1> devices{};
  std::array<spm_client_object, max_objects> objects{};
  tick.size = sizeof tick;
  device.size = devices[0].size = sizeof device;
  objects[0].size = sizeof objects[0];
  for (int waited = 0; spm_client_read_tick(client, &tick) == SPM_CLIENT_NOT_THERE; ++waited) {
    const timespec pause{0, 1'000'000};
    if (waited == 10'000) {
      std::fputs("client_reads: the daemon's loop does not tick\n", stderr);
      return 2;
    }
    nanosleep(&pause, nullptr);
  }
  const double overhead = clock_overhead();
  nlohmann::ordered_json measured = nlohmann::ordered_json::array();
  for (const int batch : {1, 16}) {
    measured.push_back(measure("the tick", batch, reads, overhead,
                               [&] { return spm_client_read_tick(client, &tick); }));
    measured.push_back(measure("one device", batch, reads, overhead,
                               [&] { return spm_client_read_device(client, 0, &device); }));
    measured.push_back(measure("all of a tick", batch, reads, overhead, [&] {
      return spm_client_read_all(client, &tick, devices.data(), devices.size(), objects.data(),
                                 objects.size());
    }));
  }
  const nlohmann::ordered_json found{
      {"clock_ns", overhead}, {"objects", tick.object_count}, {"measured", measured}};
  std::puts(found.dump().c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  int reads = 1'000'000;
  const std::string_view text = argc == 3 ? argv[2] : "";
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), reads);
  if (argc < 2 || argc > 3 ||
      (argc == 3 &&
       (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size() || reads < 1))) {
    std::fprintf(stderr, "usage: %s SOCKET [READS]\n", argv[0]);
    return 1;
  }
  spm_client_options options{};
  options.size = sizeof options;
  options.path = argv[1];
  spm_client* client = nullptr;
  std::array<char, 512> message{};
  if (spm_client_connect(&options, &client, message.data(), message.size()) != SPM_CLIENT_OK) {
    std::fprintf(stderr, "client_reads: %s\n", message.data());
    return 2;
  }
  const int code = run(client, reads);
  spm_client_disconnect(client);
  return code;
}
