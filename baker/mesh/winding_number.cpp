// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/winding_number.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace spm::baker {
namespace {

constexpr std::uint32_t kLeafTriangles = 4;
/// A cluster is far at this many of its radii and more. With that the sum is off by less than 1e-3.
constexpr double kFarRadii = 4;

constexpr std::uint32_t worth_a_thread = 8192;  ///< triangles

/// How many clusters so many triangles have.
std::uint32_t clusters_of(std::uint32_t triangles) {
  if (triangles <= kLeafTriangles) return 1;
  const std::uint32_t half = triangles / 2;
  return 1 + clusters_of(half) + clusters_of(triangles - half);
}

/// Solid angle of a triangle seen from the origin, positive where its normal points away from it
/// (Van Oosterom and Strackee 1983).
[[nodiscard]] double solid_angle(const Vector3& a, const Vector3& b, const Vector3& c) noexcept {
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double numerator = a.dot(b.cross(c));
  const double denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return numerator == 0 && denominator == 0 ? 0 : 2 * std::atan2(numerator, denominator);
}

}  // namespace

WindingNumber::WindingNumber(std::span<const Vector3> vertices,
                             std::span<const Triangle> triangles) {
  const auto count = static_cast<std::uint32_t>(triangles.size());
  if (count == 0) return;
  std::vector<Corners> unsorted(count);
  std::vector<Middle> middles(count);
  tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t i) {
    const auto& [a, b, c] = triangles[i];
    unsorted[i] = {vertices[a], vertices[b], vertices[c]};
    middles[i] = {vertices[a] + vertices[b] + vertices[c], i, 0};
  });
  triangles_.resize(count);
  clusters_.resize(clusters_of(count));
  build(unsorted, middles, 0, 0);
}

void WindingNumber::build(std::span<const Corners> unsorted, std::span<Middle> middles,
                          std::uint32_t begin, std::uint32_t self) {
  const auto count = static_cast<std::uint32_t>(middles.size());
  if (count <= kLeafTriangles) {
    for (std::uint32_t i = 0; i < count; ++i) {
      triangles_[begin + i] = unsorted[middles[i].triangle];
    }
  } else {
    Eigen::AlignedBox3d box;
    for (const Middle& middle : middles) box.extend(middle.place);
    Eigen::Index axis = 0;
    box.diagonal().maxCoeff(&axis);
    const std::uint32_t half = count / 2;
    for (std::uint32_t i = 0; i < count; ++i) middles[i].position = i;
    // In full, and equal ones in the order that they had, so that the order of all that are summed
    // depends neither on the standard library nor on threads.
    const auto before = [axis](const Middle& a, const Middle& b) {
      return a.place[axis] != b.place[axis] ? a.place[axis] < b.place[axis]
                                            : a.position < b.position;
    };
    if (count > worth_a_thread) {
      tbb::parallel_sort(middles.begin(), middles.end(), before);
    } else {
      std::sort(middles.begin(), middles.end(), before);
    }
    const auto low = [&] { build(unsorted, middles.first(half), begin, self + 1); };
    const auto high = [&] {
      build(unsorted, middles.subspan(half), begin + half, self + 1 + clusters_of(half));
    };
    if (count > worth_a_thread) {
      tbb::parallel_invoke(low, high);
    } else {
      low();
      high();
    }
  }
  clusters_[self] = summarise(begin, begin + count);
  clusters_[self].leaf = count <= kLeafTriangles;
  clusters_[self].after = self + clusters_of(count);
}

WindingNumber::Cluster WindingNumber::summarise(std::uint32_t begin, std::uint32_t end) const {
  Cluster cluster;
  cluster.begin = begin;
  cluster.end = end;
  double area = 0;
  Vector3 plain = Vector3::Zero();
  for (std::uint32_t i = begin; i < end; ++i) {
    const Corners& t = triangles_[i];
    const Vector3 centroid = (t[0] + t[1] + t[2]) / 3;
    const double size = (t[1] - t[0]).cross(t[2] - t[0]).norm() / 2;
    cluster.centre += size * centroid;
    plain += centroid;
    area += size;
  }
  cluster.centre = area > 0 ? Vector3(cluster.centre / area) : Vector3(plain / (end - begin));
  double radius2 = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const Vector3& corner : triangles_[i]) {
      radius2 = std::max(radius2, (corner - cluster.centre).squaredNorm());
    }
    add_moments(triangles_[i], cluster);
  }
  cluster.near2 = kFarRadii * kFarRadii * radius2;
  return cluster;
}

void WindingNumber::add_moments(const Corners& corners, Cluster& cluster) {
  const Vector3 a = corners[0] - cluster.centre;
  const Vector3 b = corners[1] - cluster.centre;
  const Vector3 c = corners[2] - cluster.centre;
  const Vector3 sum = a + b + c;
  const Vector3 n = (b - a).cross(c - a) / 2;
  // Integrals over the triangle, divided by its area: of x, and of x x^T.
  const Vector3 mean = sum / 3;
  const Eigen::Matrix3d square =
      (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose()) / 12;
  cluster.area += n;
  cluster.trace += mean.dot(n);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    cluster.first[i] += mean[i] * n[i];
    cluster.first[3 + i] += mean[i] * n[j] + mean[j] * n[i];
  }
  cluster.traces += 2 * square * n + square.trace() * n;
  // xxx yyy zzz, then xxy yyz zzx, then xyy yzz zxx, then xyz.
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    cluster.second[i] += square(i, i) * n[i];
    cluster.second[3 + i] += square(i, i) * n[j] + 2 * square(i, j) * n[i];
    cluster.second[6 + i] += square(j, j) * n[i] + 2 * square(i, j) * n[j];
  }
  cluster.second[9] += 2 * (square(0, 1) * n[2] + square(1, 2) * n[0] + square(2, 0) * n[1]);
}

double WindingNumber::expansion(const Cluster& cluster, const Vector3& point) noexcept {
  const Vector3 r = cluster.centre - point;
  const double inverse2 = 1 / r.squaredNorm();
  const double inverse3 = inverse2 * std::sqrt(inverse2);
  const auto& f = cluster.first;
  const auto& s = cluster.second;
  const double x = r.x();
  const double y = r.y();
  const double z = r.z();
  const double quadratic =
      f[0] * x * x + f[1] * y * y + f[2] * z * z + f[3] * x * y + f[4] * y * z + f[5] * z * x;
  const double cubic = s[0] * x * x * x + s[1] * y * y * y + s[2] * z * z * z + s[3] * x * x * y +
                       s[4] * y * y * z + s[5] * z * z * x + s[6] * x * y * y + s[7] * y * z * z +
                       s[8] * z * x * x + s[9] * x * y * z;
  return inverse3 *
         (cluster.area.dot(r) + cluster.trace -
          inverse2 * (3 * quadratic + 1.5 * cluster.traces.dot(r) - 7.5 * cubic * inverse2));
}

double WindingNumber::at(const Vector3& point) const noexcept {
  double sum = 0;
  for (std::size_t next = 0; next < clusters_.size();) {
    const Cluster& cluster = clusters_[next];
    if ((cluster.centre - point).squaredNorm() > cluster.near2) {
      sum += expansion(cluster, point);
      next = cluster.after;
      continue;
    }
    if (cluster.leaf) {
      for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
        const Corners& t = triangles_[i];
        sum += solid_angle(t[0] - point, t[1] - point, t[2] - point);
      }
    }
    ++next;
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace spm::baker
