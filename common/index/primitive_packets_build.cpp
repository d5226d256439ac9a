// SPDX-License-Identifier: Apache-2.0
#include "common/index/primitive_packets_build.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "common/query/closest_element.hpp"

namespace spm {

namespace {

/// A triangle by its stored corners: the first, and the second, which the third follows.
struct StoredTriangle {
  std::uint32_t first = 0, second = 0;
  std::array<Vector3, 3> corners;

  [[nodiscard]] Vector3 middle() const { return (corners[0] + corners[1] + corners[2]) / 3; }
};

/// The triangles of an asset's fans, of caps or of surface.
std::vector<StoredTriangle> triangles_of(const AssetView& asset, bool caps) {
  std::vector<StoredTriangle> found;
  const std::size_t children = asset.bvh.words.size() / bvh_node_words * bvh_children;
  for (std::size_t i = 0; i < children; ++i) {
    const BvhChild fan =
        unpack_child(asset.bvh.words[i / bvh_children * bvh_node_words + i % bvh_children]);
    if (fan.kind != ElementKind::fan || (fan.first >= asset.first_cap) != caps) continue;
    for (std::uint32_t k = 0; k < fan.count; ++k) {
      StoredTriangle triangle{fan.first, fan.first + k + 1, {}};
      if (!stored_corner(asset, triangle.first, triangle.corners[0]) ||
          !stored_corner(asset, triangle.second, triangle.corners[1]) ||
          !stored_corner(asset, triangle.second + 1, triangle.corners[2])) {
        break;
      }
      found.push_back(triangle);
    }
  }
  return found;
}

/// Orders triangles so that those of each packet lie near each other.
void order_by_place(std::span<StoredTriangle> triangles) {
  if (triangles.size() <= packet_width) return;
  // Halved along the longest side of the box around all, at a multiple of a packet.
  Vector3 low = triangles.front().middle(), high = low;
  for (const StoredTriangle& triangle : triangles) {
    low = low.cwiseMin(triangle.middle());
    high = high.cwiseMax(triangle.middle());
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t half = (triangles.size() / 2 + packet_width - 1) / packet_width * packet_width;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half),
                   triangles.end(), [axis](const StoredTriangle& a, const StoredTriangle& b) {
                     return a.middle()[axis] < b.middle()[axis];
                   });
  order_by_place(triangles.first(half));
  order_by_place(triangles.subspan(half));
}

class Gathering {
 public:
  explicit Gathering(const AssetView& asset) : asset_(asset) {}

  PrimitivePacketsData gather() {
    // Each kind by itself, so that those of a list follow each other.
    for (const bool clipped : {false, true}) {
      for (std::uint32_t tile = 0; tile < asset_.tiles.size(); ++tile) add_tile(tile, clipped);
    }
    add_triangles(false);
    data_.first_cap = static_cast<std::uint32_t>(data_.size());
    add_triangles(true);
    if (!widths_.empty()) {
      const auto middle = widths_.begin() + static_cast<std::ptrdiff_t>(widths_.size() / 2);
      std::nth_element(widths_.begin(), middle, widths_.end());
      data_.median_width = *middle;
    }
    return std::move(data_);
  }

 private:
  const AssetView& asset_;
  PrimitivePacketsData data_;
  std::vector<double> widths_;

  void add_tile(std::uint32_t number, bool clipped) {
    const Tile& tile = asset_.tiles[number];
    const SupportPlane& plane = asset_.planes[tile.plane];
    for (std::uint32_t part = 0; part < tile_packets; ++part) {
      CellPacket packet = cell_packet(tile, asset_.height_unit, plane, part, asset_.bvh.origin);
      packet.tile = number;
      std::array<Vector3, packet_width> normals;
      bool any = false, any_clipped = false;
      for (std::uint32_t lane = 0; lane < packet_width; ++lane) {
        const bool valid = ((tile.valid >> cell_of(packet, lane)) & 1U) != 0;
        any = any || valid;
        any_clipped = any_clipped || ((tile.clipped >> cell_of(packet, lane)) & 1U) != 0;
        normals[lane] = valid ? Vector3(surface_normal(plane, double{packet.slope_eta[lane]},
                                                       double{packet.slope_omega[lane]})
                                            .normalized())
                              : Vector3(Vector3::Zero());
      }
      if (!any || any_clipped != clipped) continue;
      if (clipped) {
        data_.clips.push_back(clip_packet(tile, packet));
        packet.clips = static_cast<std::uint32_t>(data_.clips.size());
      }
      data_.cells.push_back(packet);
      data_.normals.insert(data_.normals.end(), normals.begin(), normals.end());
      widths_.push_back(2 * double{tile.spacing});
    }
  }

  void add_triangles(bool caps) {
    std::vector<StoredTriangle> triangles = triangles_of(asset_, caps);
    order_by_place(triangles);
    const bool counts = data_.cells.empty() && !caps;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::size_t lane = i % packet_width;
      if (lane == 0) {
        data_.triangles.emplace_back();
        data_.normals.resize(data_.normals.size() + packet_width, Vector3::Zero());
      }
      const auto& [a, b, c] = triangles[i].corners;
      TrianglePacket& packet = data_.triangles.back();
      packet.first[lane] = triangles[i].first;
      packet.second[lane] = triangles[i].second;
      const Vector3& origin = asset_.bvh.origin;
      put_triangle(packet, lane, {a - origin, b - origin, c - origin});
      const Vector3 across = (b - a).cross(c - a);
      if (across.norm() > 0) {
        data_.normals[data_.normals.size() - packet_width + lane] = across.normalized();
      }
      if (counts) widths_.push_back(std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}));
    }
  }
};

}  // namespace

PrimitivePacketsData gather_primitive_packets(const AssetView& asset) {
  return Gathering(asset).gather();
}

}  // namespace spm
