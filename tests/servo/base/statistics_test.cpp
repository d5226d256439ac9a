// SPDX-License-Identifier: Apache-2.0
#include "servo/base/statistics.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "common/base/random.hpp"

namespace statistics_test {

using spm::servo::DurationHistogram;
using spm::servo::summarise;
using spm::servo::Summary;

namespace {

double nearest_rank(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace

TEST_CASE("Percentiles are those of the sorted values") {
  for (const std::size_t count : {1U, 2U, 99U, 100U, 1000U, 12345U}) {
    spm::Random random(count);
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(random.between(0, 1));
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const Summary summary = summarise(values);
    REQUIRE(summary.p50 == nearest_rank(sorted, 0.5));
    REQUIRE(summary.p99 == nearest_rank(sorted, 0.99));
    REQUIRE(summary.p999 == nearest_rank(sorted, 0.999));
    REQUIRE(summary.max == sorted.back());
  }
}

TEST_CASE("Mean and deviation are those of the values") {
  std::vector<double> values{1, 2, 3, 4};
  const Summary summary = summarise(values);
  REQUIRE(summary.mean == Approx(2.5));
  REQUIRE(summary.sd == Approx(std::sqrt(1.25)));
}

TEST_CASE("A summary of nothing is zero") {
  std::vector<double> values;
  REQUIRE(summarise(values).max == 0);
  REQUIRE(DurationHistogram().summary_us().max == 0);
}

TEST_CASE("The histogram's percentiles are at most 1/256 above those of the sorted durations") {
  for (const double largest : {300.0, 1e5, 1e10}) {
    spm::Random random(static_cast<std::uint64_t>(largest));
    DurationHistogram histogram;
    std::vector<double> values;
    for (int i = 0; i < 20'000; ++i) {
      const auto value = static_cast<std::int64_t>(random.between(0, largest));
      histogram.add(value);
      values.push_back(static_cast<double>(value) * 1e-3);
    }
    const Summary exact = summarise(values);
    const Summary summary = histogram.summary_us();
    const auto near = [](double found, double wanted) {
      return found >= wanted * (1 - 1e-12) && found <= wanted * (1 + 1.0 / 256) + 1e-9;
    };
    REQUIRE(near(summary.p50, exact.p50));
    REQUIRE(near(summary.p99, exact.p99));
    REQUIRE(near(summary.p999, exact.p999));
    REQUIRE(summary.max == Approx(exact.max));
    REQUIRE(summary.mean == Approx(exact.mean));
    REQUIRE(summary.sd == Approx(exact.sd));
  }
}

TEST_CASE("The histogram takes the longest duration there is") {
  DurationHistogram histogram;
  histogram.add(std::numeric_limits<std::int64_t>::max());
  histogram.add(-5);
  REQUIRE(histogram.summary_us().max == Approx(9.223372036854775807e15));
  REQUIRE(histogram.summary_us().p50 == 0);
}

}  // namespace statistics_test
