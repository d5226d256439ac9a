// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "common/base/units.hpp"
#include "tests/bench/geometry/bounding_boxes.hpp"
#include "tests/bench/geometry/grid_number.hpp"
#include "tests/bench/geometry/sided_mesh.hpp"
#include "tests/bench/geometry/triangle_packets.hpp"
#include "tests/bench/geometry/trilinear.hpp"
#include "tests/bench/methods/methods.hpp"

namespace spm::bench {
namespace {

using List = std::vector<std::uint32_t>;

// What the first number of a cell without triangles is.
constexpr std::uint32_t far_cell = 0;
constexpr std::uint32_t deep_cell = 1;

using List = CellTriangles::List;

/// The mesh's triangles in packets of neighbours: split in halves by their middles on the widest
/// axis, until one packet holds the rest.
class NeighbourPackets {
 public:
  explicit NeighbourPackets(const FloatMesh& mesh)
      : mesh_(mesh), order_(mesh.triangles.size()), number(mesh.triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    add(order_);
  }

 private:
  void add(std::span<std::uint32_t> part) {
    if (part.size() <= packet_triangles) {
      for (const std::uint32_t i : part) number[i] = static_cast<std::uint32_t>(packets.size());
      packets.push_back(make_packet(mesh_, part));
      return;
    }
    AxisBox box;
    for (const std::uint32_t i : part) box.extend(middle(i));
    int widest = 0;
    box.sizes().maxCoeff(&widest);
    // Whole packets in the first half, so that only the last one has empty lanes.
    const std::size_t half =
        (part.size() / 2 + packet_triangles - 1) / packet_triangles * packet_triangles;
    std::nth_element(
        part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
        [&](std::uint32_t a, std::uint32_t b) { return middle(a)[widest] < middle(b)[widest]; });
    add(part.first(half));
    add(part.subspan(half));
  }

  [[nodiscard]] Vector3 middle(std::uint32_t triangle) const {
    const auto [a, b, c] = mesh_.corners(triangle);
    return (a + b + c) / 3;
  }

  const FloatMesh& mesh_;
  std::vector<std::uint32_t> order_;

 public:
  std::vector<TriangleLanes> packets;
  std::vector<std::uint32_t> number;  ///< of each triangle's packet
};

/// Cells name their lists by the first entry and their number. An entry is a packet of the cell's
/// own triangles, or the number of one that cells share.
class TriangleGrid : public Method {
 public:
  TriangleGrid(const Model& model, const CellTriangles& cells, GridLists lists)
      : mesh_(model),
        origin_(cells.origin),
        per_cell_(1 / cells.cell),
        counts_(cells.counts),
        max_depth_(model.band.max_depth),
        lists_(lists) {
    const Clock::time_point start = Clock::now();
    open(cells);
    facts_.build_seconds = cells.seconds;
    facts_.open_seconds = mesh_.seconds() + seconds_since(start);
    facts_.name = "triangle-grid";
    facts_.settings = "cell " + format_quantity(cells.cell, Quantity::length);
    if (lists == GridLists::shared) facts_.settings += ", shared";
    facts_.setting = cells.cell;
    facts_.file_bytes = mesh_.mesh().bytes() + 4 * cells_.size() + listed_bytes_;
    facts_.resident_bytes = mesh_.bytes() + sizeof(Span) * cells_.size() +
                            sizeof(TriangleLanes) * packets_.size() + 4 * numbers_.size();
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    const Vector3 place = (point - origin_) * per_cell_;
    GridCounts cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double coordinate = place[static_cast<int>(axis)];
      if (!(coordinate >= 0 && coordinate < counts_[axis])) return far_answer();
      cell[axis] = static_cast<int>(coordinate);
    }
    const Span list = cells_[grid_number(counts_, cell)];
    if (list.count == 0) {
      return list.first == deep_cell ? deep_answer(max_depth_) : far_answer();
    }
    const std::array<float, 3> at{static_cast<float>(point.x()), static_cast<float>(point.y()),
                                  static_cast<float>(point.z())};
    const std::uint32_t nearest =
        lists_ == GridLists::own
            ? nearest_in_packets(std::span(packets_).subspan(list.first, list.count), at)
            : nearest_in_packets(packets_.data(),
                                 std::span(numbers_).subspan(list.first, list.count), at);
    return mesh_.answer(point, nearest);
  }

 private:
  struct Span {
    std::uint32_t first = far_cell, count = 0;
  };

  /// From the lists of triangles, which a file would hold, to packets.
  void open(const CellTriangles& cells) {
    NeighbourPackets neighbours(mesh_.mesh());
    // Equal lists are stored once.
    std::map<List, Span> known;
    cells_.reserve(cells.cells.size());
    for (const CellTriangles::Cell& cell : cells.cells) {
      Span list{cell.deep ? deep_cell : far_cell, 0};
      if (!cell.triangles.empty()) {
        const auto [found, added] = known.try_emplace(cell.triangles);
        if (added) {
          found->second = lists_ == GridLists::own ? add_own(cell.triangles)
                                                   : add_shared(cell.triangles, neighbours.number);
          listed_bytes_ += 4 * (1 + cell.triangles.size());
        }
        list = found->second;
      }
      cells_.push_back(list);
    }
    if (lists_ == GridLists::shared) packets_ = std::move(neighbours.packets);
  }

  Span add_own(const List& triangles) {
    Span list{static_cast<std::uint32_t>(packets_.size()), 0};
    for (std::size_t i = 0; i < triangles.size(); i += packet_triangles) {
      const std::size_t count = std::min(packet_triangles, triangles.size() - i);
      packets_.push_back(make_packet(mesh_.mesh(), std::span(triangles).subspan(i, count)));
      ++list.count;
    }
    return list;
  }

  Span add_shared(const List& triangles, const std::vector<std::uint32_t>& packet_of) {
    List found;
    for (const std::uint32_t triangle : triangles) found.push_back(packet_of[triangle]);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    const Span list{static_cast<std::uint32_t>(numbers_.size()),
                    static_cast<std::uint32_t>(found.size())};
    numbers_.insert(numbers_.end(), found.begin(), found.end());
    return list;
  }

  SidedMesh mesh_;
  Vector3 origin_;
  double per_cell_;  ///< 1/m
  GridCounts counts_;
  double max_depth_;  ///< m
  GridLists lists_;
  std::vector<Span> cells_;
  std::vector<TriangleLanes> packets_;
  std::vector<std::uint32_t> numbers_;  ///< of packets, where cells share them
  std::uint64_t listed_bytes_ = 0;      ///< of the lists as a file would hold them
};

}  // namespace

std::unique_ptr<Method> make_triangle_grid(const Model& model, const CellTriangles& cells,
                                           GridLists lists) {
  return std::make_unique<TriangleGrid>(model, cells, lists);
}

}  // namespace spm::bench
