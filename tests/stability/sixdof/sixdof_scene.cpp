// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/sixdof/sixdof_scene.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "tests/bench/base/unwrap.hpp"
#include "tests/support/triangle_octree.hpp"

namespace spm::stability {

namespace {

/// Of a tool's vertices, m.
constexpr double rounding = 1e-6;
/// Below this distance, m, the vector to the surface gives no reliable direction.
constexpr double on_surface = 1e-9;

/// A case's object, or its tool, in the form in which it is baked.
StabilityCase baked_object(const SixdofCase& tried, const test::Shape& shape) {
  StabilityCase made;
  made.name = tried.name;
  made.shape = shape;
  made.tolerance = tried.tolerance;
  made.max_depth = tried.max_depth;
  return made;
}

/// A tool as an asset of its triangles alone.
Asset asset_of(const test::Shape& tool) {
  Asset asset;
  asset.metadata.tolerance = rounding;
  asset.metadata.closed = true;
  Vector3 low = tool.vertices.front(), high = low;
  for (const Vector3& vertex : tool.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  asset.metadata.box_min = low;
  asset.metadata.box_max = high;
  const double around = (high - low).maxCoeff() / 10;
  asset.octree = test::triangle_octree(
      tool, {low - Vector3::Constant(around), (high - low).maxCoeff() + 2 * around}, rounding);
  return asset;
}

class ExactField : public SampledField {
 public:
  ExactField(const baker::ExactSurface& truth, std::size_t samples)
      : truth_(truth), last_(samples) {}

  [[nodiscard]] std::optional<SampleDepth> at(std::size_t sample, const Vector3& place) override {
    Last& last = last_[sample];
    const double moved = (place - last.place).norm();
    if (last.distance > moved) return std::nullopt;
    const baker::SurfacePoint closest = truth_.closest(place);
    const Vector3 out = closest.position - place;
    const double distance = out.norm();
    // A sample that moved less than its distance to the surface is still on the same side.
    const bool inside = -last.distance > moved || truth_.inside(place);
    last = {place, inside ? -distance : distance};
    if (!inside) return std::nullopt;
    return SampleDepth{distance, distance > on_surface ? Vector3(out / distance) : closest.normal};
  }

 private:
  struct Last {
    Vector3 place = Vector3::Zero();
    double distance = 0;  ///< m, signed; 0: nothing is known
  };
  const baker::ExactSurface& truth_;
  std::vector<Last> last_;
};

}  // namespace

SixdofScene::SixdofScene(const SixdofCase& tried)
    : object_(&prepared_object(baked_object(tried, tried.object))),
      tool_object_(&prepared_object(baked_object(tried, tried.tool))),
      places_(tried.places),
      tool_asset_(asset_of(tried.tool)),
      tool_tables_(tables_of(tool_asset_)),
      tool_(bench::unwrap(sample_surface(tool_tables_.view(), tried.spacing))),
      touch_(tried.touch),
      press_(tried.press),
      compared_depth_(tried.compared_depth) {
  for (const Vector3& vertex : tried.tool.vertices) {
    tool_radius_ = std::max(tool_radius_, vertex.norm());
  }
}

std::vector<std::unique_ptr<SampledField>> SixdofScene::exact_fields() const {
  std::vector<std::unique_ptr<SampledField>> fields;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    fields.push_back(
        std::make_unique<ExactField>(object_->model().truth, tool_.levels.back().count));
  }
  return fields;
}

SampledContact SixdofScene::contact(const std::vector<std::unique_ptr<SampledField>>& fields,
                                    const Eigen::Isometry3d& pose, double stiffness) const {
  SampledContact sum;
  const SampleLevel& finest = tool_.levels.back();
  for (std::size_t object = 0; object < fields.size(); ++object) {
    const Eigen::Isometry3d to_object = places_[object].inverse(Eigen::Isometry) * pose;
    for (std::uint32_t i = 0; i < finest.count; ++i) {
      const auto& position = tool_.places[finest.first + i].position;
      const Vector3 own(position[0], position[1], position[2]);
      const auto found = fields[object]->at(i, to_object * own);
      if (!found) continue;
      const double area = tool_.shares[finest.first + i].area;
      const Vector3 force =
          stiffness * area * found->depth * (places_[object].linear() * found->normal);
      sum.wrench.force += force;
      sum.wrench.torque += (pose.linear() * own).cross(force);
      sum.deepest = std::max(sum.deepest, found->depth);
    }
  }
  return sum;
}

double SixdofScene::area_stiffness(double stiffness) const {
  Eigen::Isometry3d pressed = touch_;
  pressed.pretranslate(press_ * compared_depth_);
  const double by_area = -contact(exact_fields(), pressed, 1).wrench.force.dot(press_);
  return stiffness * compared_depth_ / by_area;
}

double SixdofScene::steepness(double stiffness) const {
  constexpr double step = 1e-5;  // m
  const double by_area = area_stiffness(stiffness);
  const auto force_at = [&](double depth) {
    Eigen::Isometry3d pressed = touch_;
    pressed.pretranslate(press_ * depth);
    return -contact(exact_fields(), pressed, by_area).wrench.force.dot(press_);
  };
  return (force_at(compared_depth_) - force_at(compared_depth_ - step)) / step;
}

const SixdofScene& sixdof_scene(const SixdofCase& tried) {
  static std::mutex lock;
  static std::map<std::string, std::unique_ptr<SixdofScene>> scenes;
  const std::scoped_lock hold(lock);
  std::unique_ptr<SixdofScene>& scene = scenes[tried.name];
  if (!scene) scene = std::make_unique<SixdofScene>(tried);
  return *scene;
}

}  // namespace spm::stability
