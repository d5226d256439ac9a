// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/surface/sheet_pieces.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "baker/mesh/mesh_edges.hpp"
#include "baker/mesh/triangle_height.hpp"
#include "baker/surface/triangle_split.hpp"

namespace spm::baker {
namespace {

/// Lengths that count as nothing, as a share of the diagonal: far above rounding.
constexpr double nothing = 1e-9;

using Ends = std::array<std::uint32_t, 2>;

/// Sides, of which those that go straight on where no other side meets them are one.
class StraightSides {
 public:
  StraightSides(const std::vector<Vector3>& points, double touching)
      : points_(points), touching_(touching) {}

  void add(std::uint32_t from, std::uint32_t to) {
    at_[from].push_back(static_cast<std::uint32_t>(sides_.size()));
    at_[to].push_back(static_cast<std::uint32_t>(sides_.size()));
    sides_.push_back({{from, to}});
  }

  [[nodiscard]] std::vector<Ends> joined() {
    for (const auto& [point, sides] : at_) {
      if (sides.size() == 2) join_at(point, sides[0], sides[1]);
    }
    std::vector<Ends> left;
    for (const std::optional<Ends>& side : sides_) {
      if (side) left.push_back(*side);
    }
    return left;
  }

 private:
  void join_at(std::uint32_t point, std::uint32_t one, std::uint32_t other) {
    const std::uint32_t from = other_end(one, point), to = other_end(other, point);
    if (from == to || !is_between(points_[from], points_[point], points_[to])) return;
    std::replace(at_[to].begin(), at_[to].end(), other, one);
    sides_[one] = {{from, to}};
    sides_[other].reset();
  }

  [[nodiscard]] std::uint32_t other_end(std::uint32_t side, std::uint32_t point) const {
    const Ends& ends = *sides_[side];
    return ends[0] == point ? ends[1] : ends[0];
  }

  [[nodiscard]] bool is_between(const Vector3& from, const Vector3& point,
                                const Vector3& to) const {
    const Vector3 along = to - from, there = point - from;
    return along.cross(there).norm() <= touching_ * along.norm() && along.dot(there) > 0 &&
           along.dot(point - to) < 0;
  }

  const std::vector<Vector3>& points_;
  double touching_;  ///< m
  std::vector<std::optional<Ends>> sides_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> at_;  ///< sides, by their ends
};

}  // namespace

std::vector<LooseTriangle> felt_of_sheets(const Mesh& mesh,
                                          const std::map<std::uint32_t, PiecesOfSheet>& sheets,
                                          std::vector<Vector3>& points, const IsFelt& is_felt) {
  const double touching = nothing * mesh.diagonal;
  std::vector<std::uint32_t> cut;
  std::vector<LooseTriangle> felt;
  std::vector<Triangle> triangles;
  std::vector<SeenCut> cuts;
  for (const auto& [sheet, pieces] : sheets) {
    if (pieces.felt.empty()) continue;
    if (!pieces.any_hidden) {
      felt.push_back({mesh.triangles[sheet], true, sheet});
      continue;
    }
    StraightSides sides(points, touching);
    for (const HalfEdge& side : outline(points, pieces.felt)) sides.add(side.low, side.high);
    for (const auto& [from, to] : sides.joined()) {
      cuts.push_back({static_cast<std::uint32_t>(triangles.size()), {points[from], points[to]}});
    }
    triangles.push_back(mesh.triangles[sheet]);
    cut.push_back(sheet);
  }
  SplitMesh split = cut_as_seen(points, triangles, cuts);
  for (std::size_t piece = 0; piece < split.pieces.size(); ++piece) {
    const auto& [a, b, c] = split.pieces[piece];
    const std::array<Vector3, 3> corners{split.points[a], split.points[b], split.points[c]};
    const LooseTriangle one{split.pieces[piece], true, cut[split.parents[piece]]};
    // Hairs between a cut and a side that it ends at are part of neither.
    if (triangle_height(corners[0], corners[1], corners[2]) > touching && is_felt(corners, one)) {
      felt.push_back(one);
    }
  }
  points = std::move(split.points);
  return felt;
}

}  // namespace spm::baker
