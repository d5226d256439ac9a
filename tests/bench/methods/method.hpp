// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "common/base/vector.hpp"
#include "common/query/query.hpp"

namespace spm::bench {

/// Describes a method and the cost to build it. The method itself fills this in.
struct MethodFacts {
  std::string name;      ///< as the tables and the chart call it
  std::string settings;  ///< for a person, such as "cell 1 mm"
  double setting = 0;    ///< m: the tolerance or cell that was asked for; 0 where there is none
  double tolerance = 0;  ///< m: that was asked for; 0 where the method has none
  std::uint64_t file_bytes = 0;      ///< what a file must hold, so that opening makes the rest
  std::uint64_t resident_bytes = 0;  ///< what the loop holds: all that a query may read
  double build_seconds = 0;          ///< from the mesh to the file
  double open_seconds = 0;           ///< from the file in memory to the first query
};

/// A way to answer signed distance and outward normal near a surface, ready to be asked. It may
/// keep what the query before found, as a loop would: so it is asked by one thread at a time, but
/// for a method whose comment allows more.
class Method {
 public:
  Method() = default;
  virtual ~Method() = default;
  Method(const Method&) = delete;
  Method& operator=(const Method&) = delete;

  /// Answer at a point of the model's frame, metres, as query_point gives it: `deep` and `far`
  /// beyond the band.
  [[nodiscard]] virtual Answer query(const Vector3& point) const noexcept = 0;

  /// Answers at many points, one after the other unless a method has a faster way.
  virtual void query_all(std::span<const Vector3> points,
                         std::span<Answer> answers) const noexcept {
    for (std::size_t i = 0; i < points.size(); ++i) answers[i] = query(points[i]);
  }

  [[nodiscard]] const MethodFacts& facts() const noexcept { return facts_; }

 protected:
  explicit Method(MethodFacts facts) : facts_(std::move(facts)) {}
  MethodFacts facts_;
};

}  // namespace spm::bench
