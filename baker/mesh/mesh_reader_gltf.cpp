// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baker/mesh/gltf_accessors.hpp"
#include "baker/mesh/gltf_compressed.hpp"
#include "baker/mesh/mesh_limits.hpp"
#include "baker/mesh/mesh_reader.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::json;
using Transform = Eigen::Affine3d;

constexpr int strip_mode = 5, fan_mode = 6, triangles_mode = 4;
constexpr std::array<std::string_view, 4> read_extensions{
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing"};
/// Extensions that change how a surface looks and not where it is begin so.
constexpr std::array<std::string_view, 8> looks{"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                "MSFT_texture_",  "KHR_lights_",  "EXT_lights_",
                                                "MSFT_packing",   "KHR_xmp"};

class Reader : private GltfAccessors {
 public:
  using GltfAccessors::GltfAccessors;

  PolygonSoup read() {
    refuse_unread_extensions();
    add_all();
    counting_ = false;
    soup_.points.reserve(points_);
    soup_.triangles.reserve(triangles_);
    add_all();
    soup_.companion_digests = std::move(file_.companion_digests);
    soup_.unit = 1;  // by the format
    add_notes();
    return std::move(soup_);
  }

 private:
  /// Everything that the file shows. While counting, its vertices and triangles alone, so that too
  /// many are refused before any is made.
  void add_all() {
    visited_.assign(list("nodes").size(), false);
    if (!list("nodes").empty()) return walk();
    for (std::size_t i = 0; i < list("meshes").size(); ++i) add_mesh(i, Transform::Identity());
  }

  void refuse_unread_extensions() const {
    for (const Json& name : list("extensionsRequired")) {
      const std::string text = name.is_string() ? name.get<std::string>() : name.dump();
      const bool known = std::find(read_extensions.begin(), read_extensions.end(), text) !=
                             read_extensions.end() ||
                         std::any_of(looks.begin(), looks.end(), [&](std::string_view start) {
                           return text.starts_with(start);
                         });
      if (!known) {
        refuse("it needs the extension " + text + ", which is not read",
               "export the mesh without that extension");
      }
    }
  }

  /// Where the nodes begin: those of the scene that is shown, or all that have no parent.
  std::vector<std::size_t> roots() const {
    std::vector<std::size_t> found;
    if (!list("scenes").empty()) {
      const std::size_t scene = number(file_.json, "scene", 0, "the file");
      return children(item("scenes", scene), "nodes", "scene " + std::to_string(scene));
    }
    std::vector<bool> is_child(list("nodes").size(), false);
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      for (const std::size_t child :
           children(item("nodes", i), "children", "node " + std::to_string(i))) {
        if (child < is_child.size()) is_child[child] = true;
      }
    }
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i]) found.push_back(i);
    }
    return found;
  }

  std::vector<std::size_t> children(const Json& object, const char* key,
                                    const std::string& where) const {
    std::vector<std::size_t> found;
    const auto all = object.find(key);
    if (all == object.end()) return found;
    if (!all->is_array()) refuse(where + ": '" + key + "' is no list");
    for (const Json& child : *all) {
      if (!child.is_number_unsigned()) refuse(where + ": '" + key + "' has what is no node");
      found.push_back(child.get<std::size_t>());
    }
    return found;
  }

  /// Goes through the nodes without recursion, which a deep file would exhaust.
  void walk() {
    struct Step {
      std::size_t node;
      Transform above;
    };
    std::vector<Step> steps;
    const std::vector<std::size_t> first = roots();
    for (auto node = first.rbegin(); node != first.rend(); ++node) {
      steps.push_back({*node, Transform::Identity()});
    }
    while (!steps.empty()) {
      const Step step = steps.back();
      steps.pop_back();
      const std::string where = "node " + std::to_string(step.node);
      const Json& node = item("nodes", step.node);
      if (visited_[step.node]) refuse(where + " hangs below two nodes, or below itself");
      visited_[step.node] = true;
      const Transform here = step.above * transform_of(node, where);
      if (!here.matrix().allFinite()) refuse(where + " is moved or scaled beyond all numbers");
      if (node.contains("mesh")) add_meshes(node, where, here);
      const std::vector<std::size_t> below = children(node, "children", where);
      for (auto child = below.rbegin(); child != below.rend(); ++child) {
        steps.push_back({*child, here});
      }
    }
  }

  Transform transform_of(const Json& node, const std::string& where) const {
    Transform transform = Transform::Identity();
    if (const auto matrix = numbers(node, "matrix", 16, where)) {
      transform.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix->data());
      if (transform.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
        refuse(where + ": 'matrix' is no affine one");
      }
      return transform;
    }
    if (const auto t = numbers(node, "translation", 3, where)) {
      transform.translate(Vector3((*t)[0], (*t)[1], (*t)[2]));
    }
    if (const auto r = numbers(node, "rotation", 4, where)) {
      Eigen::Quaterniond turn((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
      if (!(turn.norm() > 0)) refuse(where + ": 'rotation' is no quaternion");
      transform.rotate(turn.normalized());
    }
    if (const auto s = numbers(node, "scale", 3, where)) {
      transform.scale(Vector3((*s)[0], (*s)[1], (*s)[2]));
    }
    return transform;
  }

  /// The mesh of a node, or as many as EXT_mesh_gpu_instancing places below it.
  void add_meshes(const Json& node, const std::string& where, const Transform& here) {
    const std::size_t mesh = number(node, "mesh", {}, where);
    if (!counting_) {
      const Eigen::Index rank = Eigen::FullPivLU<Eigen::Matrix3d>(here.linear()).rank();
      without_area_ += rank < 2 ? 1 : 0;
      flat_ += rank == 2 ? 1 : 0;
      skinned_ += node.contains("skin") ? 1 : 0;
    }
    const Json* const instances = extension(node, "EXT_mesh_gpu_instancing");
    if (instances == nullptr) return add_mesh(mesh, here);
    const auto attributes = instances->find("attributes");
    if (attributes == instances->end() || !attributes->is_object()) {
      refuse(where + ": its instances have no attributes");
    }
    const auto read = [&](const char* key, std::size_t width) {
      if (!attributes->contains(key)) return GltfValues{};
      return values_of(number(*attributes, key, {}, where), width, where, false);
    };
    const GltfValues moved = read("TRANSLATION", 3), turned = read("ROTATION", 4),
                     scaled = read("SCALE", 3);
    const std::size_t count = std::max({moved.count, turned.count, scaled.count});
    for (const GltfValues* values : {&moved, &turned, &scaled}) {
      if (values->first != nullptr && values->count != count) {
        refuse(where + ": the attributes of its instances are not of one number");
      }
    }
    const auto vector = [](const GltfValues& values, std::size_t i) {
      return Vector3(values.at(i, 0), values.at(i, 1), values.at(i, 2));
    };
    for (std::size_t i = 0; i < count; ++i) {
      Transform place = here;
      if (moved.first != nullptr) place.translate(vector(moved, i));
      if (turned.first != nullptr) {
        const Eigen::Quaterniond turn(turned.at(i, 3), turned.at(i, 0), turned.at(i, 1),
                                      turned.at(i, 2));
        if (!(turn.norm() > 0)) refuse(where + ": the rotation of an instance is no quaternion");
        place.rotate(turn.normalized());
      }
      if (scaled.first != nullptr) place.scale(vector(scaled, i));
      add_mesh(mesh, place);
    }
  }

  void add_mesh(std::size_t index, const Transform& transform) {
    const std::string where = "mesh " + std::to_string(index);
    const Json& mesh = item("meshes", index);
    // A mesh without triangles is placed as often, and takes as long.
    if (++placed_ > 2 * most_points) refuse(where + " is placed too often", "export fewer parts");
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) refuse(where + " has no primitives");
    for (std::size_t i = 0; i < primitives->size(); ++i) {
      const std::string part = where + ", primitive " + std::to_string(i);
      if (!(*primitives)[i].is_object()) refuse(part + " is none");
      add_primitive((*primitives)[i], part, transform);
    }
  }

  void add_primitive(const Json& primitive, const std::string& where, const Transform& transform) {
    const std::uint64_t mode = number(primitive, "mode", triangles_mode, where);
    if (mode < triangles_mode || mode > fan_mode) return;  // points and lines
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) {
      refuse(where + " has no attributes");
    }
    const auto targets = primitive.find("targets");
    if (!counting_ && targets != primitive.end() && !targets->empty()) ++morphed_;
    const std::size_t position = number(*attributes, "POSITION", {}, where);
    const Json* const packed = extension(primitive, "KHR_draco_mesh_compression");
    // Beside what is packed there may be the same values as they are.
    if (packed != nullptr && !item("accessors", position).contains("bufferView")) {
      return add_draco(*packed, where, transform);
    }
    const GltfValues points = values_of(position, 3, where, counting_);
    std::optional<GltfValues> indices;
    if (primitive.contains("indices")) {
      indices = values_of(number(primitive, "indices", {}, where), 1, where, counting_);
    }
    const std::size_t base = soup_.points.size();
    const std::size_t corners = indices ? indices->count : points.count;
    if (counting_) return count(points.count, corners / (mode == triangles_mode ? 3 : 1), where);
    for (std::size_t i = 0; i < points.count; ++i) {
      add_point(Vector3(points.at(i, 0), points.at(i, 1), points.at(i, 2)), i, where, transform);
    }
    const auto corner = [&](std::size_t i) {
      const double index = indices ? indices->at(i, 0) : static_cast<double>(i);
      if (!(index < static_cast<double>(points.count))) {
        refuse(where + ": vertex index " + std::to_string(static_cast<std::uint64_t>(index)) +
               " is out of range (" + std::to_string(points.count) + " vertices)");
      }
      return static_cast<std::uint32_t>(base + static_cast<std::size_t>(index));
    };
    const bool mirrored = transform.linear().determinant() < 0;
    const std::size_t step = mode == triangles_mode ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners; i += step) {
      const bool odd = mode == strip_mode && i % 2 == 1;
      Triangle triangle{corner(mode == fan_mode ? 0 : i), corner(i + 1), corner(i + 2)};
      if (odd != mirrored) std::swap(triangle[1], triangle[2]);
      soup_.triangles.push_back(triangle);
    }
  }

  void add_draco(const Json& packed, const std::string& where, const Transform& transform) {
    const std::size_t view = number(packed, "bufferView", {}, where);
    const auto attributes = packed.find("attributes");
    if (attributes == packed.end() || !attributes->is_object()) {
      refuse(where + ": KHR_draco_mesh_compression names no attributes");
    }
    const std::optional<DracoMesh> mesh = unpack_draco(
        view_bytes(view, where), number(*attributes, "POSITION", {}, where), most_points);
    if (!mesh) refuse(where + ": what KHR_draco_mesh_compression has packed is broken");
    if (counting_) return count(mesh->points.size(), mesh->triangles.size(), where);
    const auto base = static_cast<std::uint32_t>(soup_.points.size());
    for (std::size_t i = 0; i < mesh->points.size(); ++i) {
      add_point(mesh->points[i], i, where, transform);
    }
    const bool mirrored = transform.linear().determinant() < 0;
    for (auto [a, b, c] : mesh->triangles) {
      if (mirrored) std::swap(b, c);
      soup_.triangles.push_back({base + a, base + b, base + c});
    }
  }

  void count(std::uint64_t points, std::uint64_t triangles, const std::string& where) {
    points_ += points;
    triangles_ += triangles;
    if (points_ > most_points || triangles_ > most_points) {
      refuse(where + ": with it the file has more than " + std::to_string(most_points) +
                 " vertices or triangles, which cannot be baked",
             "export fewer parts, or a coarser mesh");
    }
  }

  void add_point(const Vector3& point, std::size_t i, const std::string& where,
                 const Transform& transform) {
    soup_.points.push_back(transform * point);
    if (!soup_.points.back().allFinite()) {
      refuse(where + ": vertex " + std::to_string(i) + " has a coordinate that is no number");
    }
  }

  void add_notes() {
    const auto note = [&](const char* what, std::size_t count) {
      if (count > 0) soup_.notes.push_back(what + std::to_string(count) + ".");
    };
    note("Parts whose skin is not applied, so that their bind pose is baked: ", skinned_);
    note("Parts whose morph targets are not applied, so that their bind pose is baked: ", morphed_);
    note("Parts without area, since a node scales them to nothing: ", without_area_);
    note("Flat parts, since a node scales them by 0 in one direction: ", flat_);
  }

  PolygonSoup soup_;
  std::vector<bool> visited_;
  bool counting_ = true;
  std::uint64_t points_ = 0, triangles_ = 0;  ///< counted
  std::uint64_t placed_ = 0;                  ///< meshes, while counting and after it
  std::size_t skinned_ = 0, morphed_ = 0, without_area_ = 0, flat_ = 0;
};

}  // namespace

PolygonSoup read_gltf(const std::string& path, std::string_view bytes, bool outside_buffers) {
  return Reader(path, bytes, outside_buffers).read();
}

}  // namespace spm::baker
