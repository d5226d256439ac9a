// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/objects/prepared_object.hpp"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/load.hpp"
#include "formats/files/sha256.hpp"
#include "tests/baker/pipeline/bake_support.hpp"
#include "tests/bench/geometry/distance_lattice.hpp"
#include "tests/bench/methods/methods.hpp"
#include "tests/bench/model/known_meshes.hpp"
#include "tests/bench/model/paper_maps.hpp"
#include "tests/stability/objects/asset_cache.hpp"

namespace spm::stability {
namespace {

/// A part that is made once, by whoever asks first; the others wait.
template <class T>
class Once {
 public:
  template <class Make>
  const T& get(const Make& make) {
    const std::lock_guard lock(mutex_);
    // Work stolen by the waiting thread could ask for this very part, and wait for itself.
    if (!made_) tbb::this_task_arena::isolate([&] { made_ = make(); });
    return *made_;
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<T> made_;
};

std::string mesh_path(const StabilityCase& tried) {
  return (std::filesystem::path(bench::shared_folder()) / "meshes" / tried.mesh).string();
}

/// A name for a mesh's content, short enough for a file's name.
std::string content_of(const StabilityCase& tried) {
  if (!tried.mesh.empty()) {
    const std::string path = mesh_path(tried);
    const auto written = std::filesystem::last_write_time(path).time_since_epoch().count();
    return fmt::format("{} {} {} {:.17g}", path, written, std::filesystem::file_size(path),
                       tried.mesh_scale);
  }
  std::string bytes;
  for (const Vector3& vertex : tried.shape.vertices) {
    bytes.append(reinterpret_cast<const char*>(vertex.data()), 3 * sizeof(double));
  }
  for (const auto& triangle : tried.shape.triangles) {
    bytes.append(reinterpret_cast<const char*>(triangle.data()), sizeof triangle);
  }
  return sha256_bytes(bytes);
}

/// Everything that a case's object depends on.
std::string recipe_of(const StabilityCase& tried) {
  return fmt::format("{} {:.17g} {:.17g} {:.17g}", content_of(tried), tried.tolerance,
                     tried.max_depth, tried.probe_radius);
}

/// Samples per side of the paper's maps.
constexpr std::uint32_t paper_resolution = 65;

/// Of its longest edge: how closely the box about the band is told.
constexpr double cells_along = 256;

/// The paper's maps, and the box about the band, for code that asks how far the asset reaches.
struct PaperTables {
  explicit PaperTables(const bench::Model& model)
      : maps(model.mesh, model.caster, {}, paper_resolution), view(maps.view()) {
    const Vector3 margin = Vector3::Constant(model.band.margin);
    view.grid.origin = model.mesh.box_min - margin;
    const Vector3 size = model.mesh.box_max + margin - view.grid.origin;
    view.grid.cell_size = size.maxCoeff() / cells_along;
    for (int k = 0; k < 3; ++k) {
      view.grid.cells[static_cast<std::size_t>(k)] =
          static_cast<std::uint32_t>(std::ceil(size[k] / view.grid.cell_size - 1e-9));
    }
  }
  bench::PaperMaps maps;
  AssetView view;
};

}  // namespace

struct PreparedObject::Implementation {
  explicit Implementation(const StabilityCase& tried) : content(content_of(tried)) {
    name = tried.mesh.empty() ? tried.name : tried.mesh;
    options.tolerance = tried.tolerance;
    options.max_depth = tried.max_depth;
    options.probe_radius = tried.probe_radius;
    mesh = tried.mesh.empty() ? test::mesh_of(tried.shape)
                              : baker::load_mesh(mesh_path(tried), {tried.mesh_scale, {}});
  }

  std::string name, content;
  baker::Mesh mesh;
  baker::BakeOptions options;  ///< of the `sparse` asset
  Once<bench::Model> model;
  Once<MappedAsset> sparse;
  Once<PaperTables> paper;
  Once<bench::FloatMesh> float_mesh;
  Once<bench::Method> distance_field;
};

PreparedObject::PreparedObject(const StabilityCase& tried)
    : implementation_(std::make_unique<Implementation>(tried)) {}

PreparedObject::~PreparedObject() = default;

const bench::Model& PreparedObject::model() const {
  Implementation& own = *implementation_;
  return own.model.get([&] {
    auto model = std::make_unique<bench::Model>(
        bench::ModelSource{own.name, own.mesh.path, *own.options.tolerance}, own.mesh);
    model->band = {own.options.max_depth, own.options.probe_radius + own.options.max_depth / 4};
    return model;
  });
}

const AssetView& PreparedObject::sparse() const {
  Implementation& own = *implementation_;
  return own.sparse.get([&] { return cached_asset(own.mesh, own.content, own.options); }).view();
}

std::uint64_t PreparedObject::sparse_bytes() const {
  static_cast<void>(sparse());
  return implementation_->sparse.get([] { return std::unique_ptr<MappedAsset>(); }).bytes().total;
}

const AssetView& PreparedObject::paper() const {
  Implementation& own = *implementation_;
  return own.paper.get([&] { return std::make_unique<PaperTables>(model()); }).view;
}

const bench::FloatMesh& PreparedObject::float_mesh() const {
  return implementation_->float_mesh.get(
      [&] { return std::make_unique<bench::FloatMesh>(model().surface); });
}

const bench::Method& PreparedObject::distance_field() const {
  return implementation_->distance_field.get(
      [&] { return bench::make_dense_sdf(bench::sample_band(model(), field_cell)); });
}

const PreparedObject& prepared_object(const StabilityCase& tried) {
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<PreparedObject>> objects;
  std::string recipe = recipe_of(tried);
  const std::lock_guard lock(mutex);
  std::unique_ptr<PreparedObject>& object = objects[std::move(recipe)];
  if (!object) object = std::make_unique<PreparedObject>(tried);
  return *object;
}

std::string why_unprepared(const StabilityCase& tried) {
  if (tried.mesh.empty()) return {};
  try {
    if (std::filesystem::is_regular_file(mesh_path(tried))) return {};
    return tried.mesh + " is not among the shared meshes";
  } catch (const baker::BakeError& error) {
    return error.what();
  }
}

}  // namespace spm::stability
