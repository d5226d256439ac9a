// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/reachability/reachability_field.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "baker/base/progress_counter.hpp"
#include "common/base/octant.hpp"

namespace spm::baker {

namespace {

constexpr double max_voxels = 8e6;
/// Size of voxels, as a share of the diagonal, where no small ball needs finer ones.
constexpr double coarsest_share = 1.0 / 256;
/// Voxels in a ball's radius: their half diagonal is then a ninth of it.
constexpr double voxels_per_radius = 8;
constexpr double rim = 3;           ///< voxels beyond a ball that touches the box from outside
constexpr std::int32_t block = 16;  ///< voxels a side of a task; a power of two

enum Voxel : std::uint8_t { blocked, passable, reached };

const double half_diagonal = std::sqrt(3.0) / 2;  ///< of a unit cube

/// Finds the voxels of one block that contain a place where the ball fits. A distance changes by at
/// most a metre a metre. So the distance at its middle decides for most blocks of voxels as a
/// whole.
class BlockSearch {
 public:
  BlockSearch(const Caster& caster, double radius) : caster_(caster), radius_(radius) {}

  /// Calls `fill` with the lowest voxel and the edge of each cube of voxels to which one result
  /// applies.
  template <class Middle, class Fill>
  void search(const std::array<std::int32_t, 3>& least, std::int32_t edge, double size,
              const Middle& middle, const Fill& fill) const {
    const Vector3 at = middle(least) + Vector3::Constant((edge - 1) * size / 2);
    const double around = half_diagonal * edge * size;
    const double distance = caster_.closest(at).distance;
    if (distance + around < radius_) return fill(least, edge, blocked);
    // The farthest voxel's middle is a voxel's half diagonal nearer than the block's corner.
    if (edge == 1 || distance - around + 2 * half_diagonal * size >= radius_) {
      return fill(least, edge, passable);
    }
    const std::int32_t half = edge / 2;
    for (std::size_t octant = 0; octant < 8; ++octant) {
      const auto begin = [&](std::size_t axis) {
        return least[axis] + (is_upper(octant, axis) ? half : 0);
      };
      search({begin(0), begin(1), begin(2)}, half, size, middle, fill);
    }
  }

 private:
  const Caster& caster_;
  double radius_;
};

/// Squared distances of the voxels of a row to the nearest one, from the squared distances within
/// planes across the row. The lower envelope of parabolas, exact in whole numbers (Meijster and
/// others, 2000).
class RowTransform {
 public:
  /// Transforms the row `values` of squared distances, which are `stride` apart, in place.
  void operator()(std::uint32_t* values, std::size_t stride, std::int32_t count) {
    height_.resize(static_cast<std::size_t>(count));
    for (std::int32_t i = 0; i < count; ++i)
      height_[i] = values[static_cast<std::size_t>(i) * stride];
    sites_.clear();
    for (std::int32_t u = 0; u < count; ++u) {
      while (!sites_.empty() &&
             value(sites_.back().first, sites_.back().second) > value(u, sites_.back().second)) {
        sites_.pop_back();
      }
      if (sites_.empty()) {
        sites_.emplace_back(u, 0);
      } else if (const std::int64_t from = 1 + separation(sites_.back().first, u); from < count) {
        sites_.emplace_back(u, from);
      }
    }
    std::size_t site = sites_.size() - 1;
    for (std::int32_t u = count - 1; u >= 0; --u) {
      values[static_cast<std::size_t>(u) * stride] =
          static_cast<std::uint32_t>(value(sites_[site].first, u));
      if (u == sites_[site].second && site > 0) --site;
    }
  }

 private:
  std::vector<std::int64_t> height_;
  std::vector<std::pair<std::int64_t, std::int64_t>>
      sites_;  ///< a parabola, and the place where it begins

  [[nodiscard]] std::int64_t value(std::int64_t parabola, std::int64_t place) const {
    const std::int64_t step = place - parabola;
    return step * step + height_[static_cast<std::size_t>(parabola)];
  }

  /// The last place where parabola `a` is not above `b`, which lies after `a`.
  [[nodiscard]] std::int64_t separation(std::int64_t a, std::int64_t b) const {
    const std::int64_t above =
        b * b - a * a + height_[static_cast<std::size_t>(b)] - height_[static_cast<std::size_t>(a)];
    const std::int64_t twice = 2 * (b - a);
    return above >= 0 ? above / twice : -((-above + twice - 1) / twice);
  }
};

}  // namespace

double ReachabilityField::voxel_size(const Vector3& size, double radius) noexcept {
  double voxel = std::min(coarsest_share * size.norm(), radius / voxels_per_radius);
  const auto count = [&] { return ((size.array() + 2 * radius) / voxel + 2 * rim + block).prod(); };
  while (count() > max_voxels) voxel *= 1.02;
  return voxel;
}

ReachabilityField::ReachabilityField(const Caster& caster, const Vector3& low, const Vector3& high,
                                     double radius, const std::optional<OrientedBox>& workspace,
                                     const Progress& progress) {
  size_ = voxel_size(high - low, radius);
  const double around = radius + rim * size_;
  origin_ = low - Vector3::Constant(around);
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = high[axis] - low[axis] + 2 * around;
    // Whole blocks, so that a task's cubes of voxels halve down to single ones.
    cells_[axis] = (static_cast<std::int32_t>(extent / size_) / block + 1) * block;
  }
  state_.assign(at({0, 0, cells_[2]}), blocked);
  find_passable(caster, radius, progress);
  flood_from_outside();
  if (workspace) flood_within(*workspace);
  measure_distances();
}

std::size_t ReachabilityField::at(const Index& index) const noexcept {
  return (static_cast<std::size_t>(index[2]) * cells_[1] + index[1]) * cells_[0] + index[0];
}

Vector3 ReachabilityField::middle(const Index& index) const noexcept {
  return origin_ + size_ * Vector3(index[0] + 0.5, index[1] + 0.5, index[2] + 0.5);
}

double ReachabilityField::coarseness() const noexcept { return half_diagonal * size_; }

void ReachabilityField::find_passable(const Caster& caster, double radius,
                                      const Progress& progress) {
  const BlockSearch search(caster, radius);
  const Index blocks{cells_[0] / block, cells_[1] / block, cells_[2] / block};
  const std::size_t count = static_cast<std::size_t>(blocks[0]) * blocks[1] * blocks[2];
  ProgressCounter counter(progress, "finding what can be reached", count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t number) {
    const auto n = static_cast<std::int32_t>(number);
    const Index least{n % blocks[0] * block, n / blocks[0] % blocks[1] * block,
                      n / blocks[0] / blocks[1] * block};
    search.search(
        least, block, size_, [&](const Index& index) { return middle(index); },
        [&](const Index& from, std::int32_t edge, Voxel verdict) {
          for (std::int32_t z = from[2]; z < from[2] + edge; ++z) {
            for (std::int32_t y = from[1]; y < from[1] + edge; ++y) {
              std::fill_n(state_.begin() + static_cast<std::ptrdiff_t>(at({from[0], y, z})), edge,
                          verdict);
            }
          }
        });
    counter.done();
  });
}

void ReachabilityField::flood_from_outside() {
  std::vector<std::uint32_t> open;
  const auto seed = [&](const Index& index) {
    if (state_[at(index)] != passable) return;
    state_[at(index)] = reached;
    open.push_back(static_cast<std::uint32_t>(at(index)));
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int across = (axis + 1) % 3, along = (axis + 2) % 3;
    for (const std::int32_t side : {0, cells_[axis] - 1}) {
      for (std::int32_t i = 0; i < cells_[across]; ++i) {
        for (std::int32_t k = 0; k < cells_[along]; ++k) {
          Index index{};
          index[axis] = side;
          index[across] = i;
          index[along] = k;
          seed(index);
        }
      }
    }
  }
  flood(open);
}

void ReachabilityField::flood_within(const OrientedBox& workspace) {
  const Vector3 spread = workspace.axes.cwiseAbs() * workspace.half;
  Index from{}, to{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto index_of = [&](double place) {
      return static_cast<std::int32_t>(
          std::clamp((place - origin_[axis]) / size_, 0.0, cells_[axis] - 1.0));
    };
    from[axis] = index_of(workspace.middle[axis] - spread[axis]);
    to[axis] = index_of(workspace.middle[axis] + spread[axis]);
  }
  std::vector<std::uint32_t> fitting;
  for (Index index = from; index[2] <= to[2]; ++index[2]) {
    for (index[1] = from[1]; index[1] <= to[1]; ++index[1]) {
      for (index[0] = from[0]; index[0] <= to[0]; ++index[0]) {
        const std::uint8_t voxel = state_[at(index)];
        if (voxel == blocked || !may_touch(workspace, middle(index), size_)) continue;
        if (voxel == reached) return;
        fitting.push_back(static_cast<std::uint32_t>(at(index)));
      }
    }
  }
  for (const std::uint32_t voxel : fitting) state_[voxel] = reached;
  flood(fitting);
}

/// Floods over the faces of voxels. A place on an edge or a corner makes all voxels around it
/// passable.
void ReachabilityField::flood(std::vector<std::uint32_t>& open) {
  const auto width = static_cast<std::uint32_t>(cells_[0]);
  const std::uint32_t layer = width * static_cast<std::uint32_t>(cells_[1]);
  const auto visit = [&](std::uint32_t voxel) {
    if (state_[voxel] != passable) return;
    state_[voxel] = reached;
    open.push_back(voxel);
  };
  while (!open.empty()) {
    const std::uint32_t voxel = open.back();
    open.pop_back();
    const std::uint32_t x = voxel % width, y = voxel / width % (layer / width), z = voxel / layer;
    if (x > 0) visit(voxel - 1);
    if (x + 1 < width) visit(voxel + 1);
    if (y > 0) visit(voxel - width);
    if (y + 1 < layer / width) visit(voxel + width);
    if (z > 0) visit(voxel - layer);
    if (z + 1 < static_cast<std::uint32_t>(cells_[2])) visit(voxel + layer);
  }
}

void ReachabilityField::measure_distances() {
  const auto far = static_cast<std::uint32_t>(cells_[0] + cells_[1] + cells_[2]);
  square_.assign(state_.size(), far * far);
  const auto width = static_cast<std::size_t>(cells_[0]);
  const std::size_t layer = width * static_cast<std::size_t>(cells_[1]);
  tbb::parallel_for(std::int32_t{0}, cells_[2], [&](std::int32_t z) {
    thread_local RowTransform transform;
    std::uint32_t* plane = square_.data() + static_cast<std::size_t>(z) * layer;
    for (std::int32_t y = 0; y < cells_[1]; ++y) {
      std::uint32_t* row = plane + static_cast<std::size_t>(y) * width;
      for (std::size_t x = 0; x < width; ++x) {
        if (state_[at({0, y, z}) + x] == reached) row[x] = 0;
      }
      transform(row, 1, cells_[0]);
    }
    for (std::size_t x = 0; x < width; ++x) transform(plane + x, width, cells_[1]);
  });
  tbb::parallel_for(std::int32_t{0}, cells_[1], [&](std::int32_t y) {
    thread_local RowTransform transform;
    for (std::size_t x = 0; x < width; ++x) {
      transform(square_.data() + static_cast<std::size_t>(y) * width + x, layer, cells_[2]);
    }
  });
  state_ = {};
}

bool ReachabilityField::near(const Vector3& point, double distance) const noexcept {
  const Vector3 place = (point - origin_) / size_;
  Index index{};
  for (int axis = 0; axis < 3; ++axis) {
    // Outside the voxels the ball fits everywhere.
    if (!(place[axis] >= 0 && place[axis] < cells_[axis])) return true;
    index[axis] = static_cast<std::int32_t>(place[axis]);
  }
  const double to_voxel = size_ * std::sqrt(static_cast<double>(square_[at(index)]));
  return to_voxel - (point - middle(index)).norm() - coarseness() <= distance;
}

}  // namespace spm::baker
