// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/base/latency_histogram.hpp"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "common/base/random.hpp"

namespace latency_histogram_test {

using namespace spm::servo;
using spm::Random;

namespace {

double nearest_rank_of(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

TEST_CASE("A latency histogram's percentiles are at most 1/32 above the true ones, its max exact") {
  for (const double largest : {40.0, 3e4, 2e6, 5e11}) {
    Random random(static_cast<std::uint64_t>(largest));
    LatencyHistogram histogram;
    std::vector<double> values;
    for (int i = 0; i < 5000; ++i) {
      const auto value = static_cast<std::int64_t>(random.between(0, largest));
      histogram.add(value);
      values.push_back(static_cast<double>(value) * 1e-3);
    }
    std::sort(values.begin(), values.end());
    const auto json = histogram.json_us();
    for (const auto& [name, share] : {std::pair("p50", 0.5), std::pair("p99", 0.99)}) {
      const double exact = nearest_rank_of(values, share);
      const double told = json.at(name).get<double>();
      REQUIRE(told >= exact * (1 - 1e-12));
      REQUIRE(told <= exact * (1 + 1.0 / 32 + 1e-12));
    }
    REQUIRE(json.at("max").get<double>() == Approx(values.back()).epsilon(1e-15));
  }
}

TEST_CASE("A latency histogram of nothing is zero, and takes what no clock should give") {
  LatencyHistogram histogram;
  REQUIRE(histogram.json_us().dump() == R"({"p50":0.0,"p99":0.0,"max":0.0})");
  histogram.add(-5);
  REQUIRE(histogram.json_us().at("max") == 0.0);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  REQUIRE(histogram.json_us().at("max") == Approx(9.223372e15));
}

TEST_CASE("A latency histogram may be read while it counts") {
  LatencyHistogram histogram;
  std::atomic<bool> stop{false};
  std::thread counts([&] {
    for (std::int64_t i = 0; !stop.load(); ++i) histogram.add(i % 100'000);
  });
  double last_max = 0;
  for (int i = 0; i < 200; ++i) {
    const auto json = histogram.json_us();
    const double max = json.at("max");
    REQUIRE(max >= last_max);
    last_max = max;
    REQUIRE(json.at("p50").get<double>() <= json.at("p99").get<double>());
    REQUIRE(json.at("p99").get<double>() <= max);
  }
  stop.store(true);
  counts.join();
}

}  // namespace latency_histogram_test
