// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/overlap_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/rigid_pose.hpp"
#include "common/query/query.hpp"
#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

/// Integrals over the overlap's boundary, relative to a point that lies near it.
struct Boundary {
  Vector3 flux = Vector3::Zero();     ///< of N
  Vector3 turn = Vector3::Zero();     ///< of x cross N
  Vector3 along = Vector3::Zero();    ///< of x_i N_i
  Vector3 squares = Vector3::Zero();  ///< of x_i^2 N_i
  Vector3 moment = Vector3::Zero();   ///< of x
  double area = 0;

  void add(const Vector3& place, const Vector3& normal, double share) noexcept {
    flux += share * normal;
    turn += share * place.cross(normal);
    along += share * place.cwiseProduct(normal);
    squares += share * place.cwiseProduct(place).cwiseProduct(normal);
    moment += share * place;
    area += share;
  }
};

Boundary joined(const Boundary& a, const Boundary& b) noexcept {
  return {a.flux + b.flux,       a.turn + b.turn,     a.along + b.along,
          a.squares + b.squares, a.moment + b.moment, a.area + b.area};
}

/// Part of a patch that lies under a surface, if the patch is spread evenly over `half` to both
/// sides of its middle, which is at this signed distance.
double part_inside(double distance, double half) noexcept {
  if (!(half > 0)) return distance < 0 ? 1 : 0;
  return std::clamp(0.5 - distance / (2 * half), 0.0, 1.0);
}

/// Descends the samples of one object, and integrates over those inside the other.
class Walk {
 public:
  /// `pose` takes the samples' frame to that of the field; `frame` takes the field's to that of the
  /// result.
  Walk(const SurfaceSamples& samples, const AssetView& field, const Eigen::Isometry3d& pose,
       const Eigen::Isometry3d& frame, const Vector3& about) noexcept
      : samples_(samples), field_(field), pose_(pose), frame_(frame), about_(about) {}

  Boundary boundary;
  std::uint64_t tested = 0;

  void run() noexcept {
    if (samples_.levels.empty()) return;
    const SampleLevel& coarsest = samples_.levels.front();
    for (std::uint32_t k = 0; k < coarsest.count; ++k) visit(coarsest.first + k, max_levels);
  }

 private:
  static constexpr int max_levels = 24;

  const SurfaceSamples& samples_;
  const AssetView& field_;
  const Eigen::Isometry3d& pose_;
  const Eigen::Isometry3d& frame_;
  const Vector3& about_;

  // As deep as there are levels, which are at most as many as a cube's number has bits.
  void visit(std::uint32_t sample, int levels_left) noexcept {
    const SampleChildren below = samples_.below(sample);
    if (below.count == 0) {
      weigh(sample);
      return;
    }
    if (levels_left == 0 || clear(sample)) return;
    for (std::uint32_t k = 0; k < below.count; ++k) visit(below.first + k, levels_left - 1);
  }

  /// Whether a sample and all below it are outside.
  [[nodiscard]] bool clear(std::uint32_t sample) noexcept {
    const Vector3 place = pose_ * vector_of(samples_.places[sample].position);
    // Patches of the finest samples extend beyond their middles.
    const double radius = static_cast<double>(samples_.places[sample].radius) +
                          samples_.levels.back().bound + field_.tolerance;
    ++tested;
    const Answer answer = query_point(field_, place);
    if (answer.status == Status::far) return clearance(field_, place) >= radius;
    return answer.status == Status::exact && answer.distance >= radius;
  }

  void weigh(std::uint32_t sample) noexcept {
    const SampleShare& share = samples_.shares[sample];
    const SampleSpread& spread = samples_.spreads[sample];
    const Vector3 middle =
        pose_ * Vector3(vector_of(samples_.places[sample].position) + vector_of(spread.middle));
    ++tested;
    const Answer answer = query_point(field_, middle);
    if (answer.status != Status::exact && answer.status != Status::deep) return;
    const Vector3 normal = pose_.linear() * share.normal();
    double part = 1;
    if (answer.status == Status::exact) {
      const double cosine = answer.normal.dot(normal);
      part = part_inside(answer.distance, static_cast<double>(spread.spread) *
                                              std::sqrt(std::max(0.0, 1 - cosine * cosine)));
    }
    if (!(part > 0)) return;
    boundary.add(frame_ * middle - about_, frame_.linear() * normal,
                 part * static_cast<double>(share.area));
  }
};

}  // namespace

OverlapVolume overlap_volume(const SampledObject& object1, const SampledObject& object2,
                             const Eigen::Isometry3d& pose2) noexcept {
  OverlapVolume result;
  if (object1.field == nullptr || object2.field == nullptr || object1.samples == nullptr ||
      object2.samples == nullptr || !keeps_lengths(pose2)) {
    return result;
  }
  const Vector3 about = (object1.samples->centre + pose2 * object2.samples->centre) / 2;
  const Eigen::Isometry3d whole = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d back = pose2.inverse(Eigen::Isometry);
  Walk of2(*object2.samples, *object1.field, pose2, whole, about);
  of2.run();
  Walk of1(*object1.samples, *object2.field, back, pose2, about);
  of1.run();
  const Boundary &b2 = of2.boundary, &b1 = of1.boundary;
  result.tested = of1.tested + of2.tested;
  result.contact_area = b2.area;
  result.push = -b2.flux;
  result.turn = -(b2.turn + about.cross(b2.flux));
  const Boundary all = joined(b1, b2);
  if (!(all.area > 0)) return result;
  // The boundary is closed apart from the sampling; relative to its own middle the gaps weigh
  // least.
  const Vector3 shift = all.moment / all.area;
  const double volume = (all.along.sum() - shift.dot(all.flux)) / 3;
  if (!(volume > 0)) return result;
  const Vector3 squares = all.squares - 2 * shift.cwiseProduct(all.along) +
                          shift.cwiseProduct(shift).cwiseProduct(all.flux);
  result.volume = volume;
  result.centre = about + shift + squares / (2 * volume);
  return result;
}

Wrench overlap_wrench(const OverlapVolume& overlap, double stiffness,
                      const Vector3& about) noexcept {
  const double pressure = stiffness * overlap.volume;
  return {pressure * overlap.push, pressure * (overlap.turn - about.cross(overlap.push))};
}

}  // namespace spm
