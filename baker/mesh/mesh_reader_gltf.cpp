// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/gltf_file.hpp"
#include "baker/mesh/mesh_reader.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::json;
using Transform = Eigen::Affine3d;

/// Points, and triangles: many primitives may name the same few bytes.
constexpr std::uint64_t most_points = std::uint64_t{1} << 25U;
constexpr int strip_mode = 5, fan_mode = 6, triangles_mode = 4;
constexpr std::array<std::string_view, 3> unread_extensions{
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"};

/// Values of a buffer: `count` times `width` numbers of a component type, as glTF numbers them.
struct Values {
  const char* first = nullptr;
  std::size_t count = 0, width = 0, stride = 0;
  int type = 0;
  bool normalized = false;
};

std::size_t component_bytes(int type) {
  switch (type) {
    case 5120:  // signed and unsigned bytes
    case 5121:
      return 1;
    case 5122:  // 16 bits
    case 5123:
      return 2;
    case 5125:  // unsigned 32 bits, float
    case 5126:
      return 4;
    default:
      return 0;
  }
}

template <class T>
double integer_at(const char* at, bool normalized) {
  T value{};
  std::memcpy(&value, at, sizeof value);
  if (!normalized) return static_cast<double>(value);
  return std::max(-1.0, static_cast<double>(value) / std::numeric_limits<T>::max());
}

double component(const Values& values, std::size_t row, std::size_t column) {
  const char* const at = values.first + row * values.stride + column * component_bytes(values.type);
  switch (values.type) {
    case 5120:
      return integer_at<std::int8_t>(at, values.normalized);
    case 5121:
      return integer_at<std::uint8_t>(at, values.normalized);
    case 5122:
      return integer_at<std::int16_t>(at, values.normalized);
    case 5123:
      return integer_at<std::uint16_t>(at, values.normalized);
    case 5125:
      return integer_at<std::uint32_t>(at, values.normalized);
    default: {
      float value = 0;
      std::memcpy(&value, at, sizeof value);
      return value;
    }
  }
}

class Reader {
 public:
  Reader(const std::string& path, std::string_view bytes, bool outside_buffers)
      : path_(path), file_(open_gltf(path, bytes, outside_buffers)) {}

  PolygonSoup read() {
    refuse_unread_extensions();
    add_all();
    counting_ = false;
    soup_.points.reserve(points_);
    soup_.triangles.reserve(triangles_);
    add_all();
    soup_.companion_digests = std::move(file_.companion_digests);
    return std::move(soup_);
  }

 private:
  [[noreturn]] void refuse(const std::string& cause,
                           const std::string& cure = "export the mesh again") const {
    throw BakeError(ExitCode::invalid_input, path_ + ": " + cause + "; " + cure);
  }

  /// Everything that the file shows. While counting, its vertices and triangles alone, so that too
  /// many are refused before any is made.
  void add_all() {
    visited_.assign(list("nodes").size(), false);
    if (!list("nodes").empty()) return walk();
    for (std::size_t i = 0; i < list("meshes").size(); ++i) add_mesh(i, Transform::Identity());
  }

  const Json& list(const char* name) const {
    static const Json none = Json::array();
    const auto found = file_.json.find(name);
    if (found == file_.json.end()) return none;
    if (!found->is_array()) refuse(std::string("'") + name + "' is no list");
    return *found;
  }

  const Json& item(const char* name, std::size_t index) const {
    const Json& all = list(name);
    if (index >= all.size() || !all[index].is_object()) {
      refuse(std::string("there is no ") + std::to_string(index) + " in '" + name + "', of " +
             std::to_string(all.size()));
    }
    return all[index];
  }

  /// A whole number of an object; `otherwise` where it is not there.
  std::uint64_t number(const Json& object, const char* key, std::optional<std::uint64_t> otherwise,
                       const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end() && otherwise) return *otherwise;
    if (found == object.end() || !found->is_number_unsigned()) {
      refuse(where + ": '" + key + "' is " +
             (found == object.end() ? "missing" : "no whole number from 0"));
    }
    return found->get<std::uint64_t>();
  }

  /// Numbers of an object, so many; nothing where they are not there.
  std::optional<std::vector<double>> numbers(const Json& object, const char* key, std::size_t count,
                                             const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    std::vector<double> values;
    if (found->is_array()) {
      for (const Json& value : *found) {
        if (value.is_number()) values.push_back(value.get<double>());
      }
    }
    if (values.size() != count) {
      refuse(where + ": '" + key + "' are not " + std::to_string(count) + " numbers");
    }
    return values;
  }

  void refuse_unread_extensions() const {
    for (const Json& name : list("extensionsRequired")) {
      for (const std::string_view unread : unread_extensions) {
        if (name == std::string(unread)) {
          refuse("it needs the extension " + std::string(unread) + ", which is not read",
                 "export the mesh without compression or instances");
        }
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
      if (node.contains("mesh")) add_mesh(number(node, "mesh", {}, where), here);
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

  void add_mesh(std::size_t index, const Transform& transform) {
    const std::string where = "mesh " + std::to_string(index);
    const Json& mesh = item("meshes", index);
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) refuse(where + " has no primitives");
    for (std::size_t i = 0; i < primitives->size(); ++i) {
      const std::string part = where + ", primitive " + std::to_string(i);
      if (!(*primitives)[i].is_object()) refuse(part + " is none");
      add_primitive((*primitives)[i], part, transform);
    }
  }

  /// The numbers that an accessor names, all of which are in its buffer.
  Values values_of(std::size_t index, std::size_t width, const std::string& where) const {
    const Json& accessor = item("accessors", index);
    const std::string place = where + ", accessor " + std::to_string(index);
    if (accessor.contains("sparse") || !accessor.contains("bufferView")) {
      refuse(place + " is sparse, which is not read", "export the mesh without sparse accessors");
    }
    const auto type = accessor.find("type");
    if (type == accessor.end() || *type != (width == 1 ? "SCALAR" : "VEC3")) {
      refuse(place + " is of another type");
    }
    const Json& view = item("bufferViews", number(accessor, "bufferView", {}, place));
    const std::size_t buffer = number(view, "buffer", {}, place);
    if (buffer >= file_.buffers.size()) {
      refuse(place + ": there is no buffer " + std::to_string(buffer));
    }
    Values values;
    values.count = number(accessor, "count", {}, place);
    values.width = width;
    values.type = static_cast<int>(number(accessor, "componentType", {}, place));
    const auto normalized = accessor.find("normalized");
    values.normalized = normalized != accessor.end() && *normalized == true;
    const std::size_t size = component_bytes(values.type) * width;
    const bool index_type = values.type == 5121 || values.type == 5123 || values.type == 5125;
    if (size == 0 || (width == 1 && !index_type)) {
      refuse(place + ": component type " + std::to_string(values.type) + " is none of its kind");
    }
    values.stride = number(view, "byteStride", size, place);
    const std::uint64_t start = number(view, "byteOffset", 0, place),
                        length = number(view, "byteLength", {}, place),
                        offset = number(accessor, "byteOffset", 0, place);
    const std::uint64_t bytes = file_.buffers[buffer].size();
    if (values.stride < size || start > bytes || length > bytes - start || offset > length ||
        (values.count > 0 &&
         (length - offset < size || (length - offset - size) / values.stride < values.count - 1))) {
      refuse(place + ": " + std::to_string(values.count) + " values are more than buffer " +
             std::to_string(buffer) + " has");
    }
    values.first = file_.buffers[buffer].data() + start + offset;
    return values;
  }

  void add_primitive(const Json& primitive, const std::string& where, const Transform& transform) {
    const std::uint64_t mode = number(primitive, "mode", triangles_mode, where);
    if (mode < triangles_mode || mode > fan_mode) return;  // points and lines
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) {
      refuse(where + " has no attributes");
    }
    const Values points = values_of(number(*attributes, "POSITION", {}, where), 3, where);
    std::optional<Values> indices;
    if (primitive.contains("indices")) {
      indices = values_of(number(primitive, "indices", {}, where), 1, where);
    }
    const std::size_t base = soup_.points.size();
    const std::size_t corners = indices ? indices->count : points.count;
    if (counting_) {
      points_ += points.count;
      triangles_ += corners / (mode == triangles_mode ? 3 : 1);
      if (points_ > most_points || triangles_ > most_points) {
        refuse(where + ": with it the file has more than " + std::to_string(most_points) +
                   " vertices or triangles, which cannot be baked",
               "export fewer parts, or a coarser mesh");
      }
      return;
    }
    add_points(points, where, transform);
    const auto corner = [&](std::size_t i) {
      const double index = indices ? component(*indices, i, 0) : static_cast<double>(i);
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

  void add_points(const Values& points, const std::string& where, const Transform& transform) {
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vector3 point(component(points, i, 0), component(points, i, 1),
                          component(points, i, 2));
      soup_.points.push_back(transform * point);
      if (!soup_.points.back().allFinite()) {
        refuse(where + ": vertex " + std::to_string(i) + " has a coordinate that is no number");
      }
    }
  }

  const std::string& path_;
  GltfFile file_;
  PolygonSoup soup_;
  std::vector<bool> visited_;
  bool counting_ = true;
  std::uint64_t points_ = 0, triangles_ = 0;  ///< counted
};

}  // namespace

PolygonSoup read_gltf(const std::string& path, std::string_view bytes, bool outside_buffers) {
  return Reader(path, bytes, outside_buffers).read();
}

}  // namespace spm::baker
