// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/cell_fit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "common/surface/closest_on_map.hpp"

namespace spm::baker {

namespace {

/// Sample points of a cell along an axis, corners included.
constexpr int lattice = 5;
/// More candidates than this in a cell cost more time than triangles would.
constexpr std::size_t max_candidates = 8;
/// Share of the tolerance by which a sample point may be off. The rest is for the points between.
constexpr double accepted_share = 0.6;
constexpr double accepted_cosine = 0.985;  // 10 degrees
/// Closer to the surface than this share of the tolerance, the direction is not tested: there the
/// rounding of an edge is within the tolerance.
constexpr double directionless_share = 0.3;

/// A map seen at this slope may be off by this many tolerances along its rays.
constexpr double covering_slope = 3;

constexpr std::int64_t nowhere = -1;

}  // namespace

/// A point of a cell with the true answer.
struct CellFitter::Sample {
  Vector3 point;
  ClosestPoint truth;
};

/// The answer of one map at a sample. Its normal is computed only where it is needed.
struct CellFitter::Reply {
  bool valid = false;
  double distance = 0;
  double rank = std::numeric_limits<double>::infinity();
  std::uint32_t candidate = 0;
  MapCell cell;
};

CellFitter::CellFitter(const AssetView& asset, const GridData& grid, const Caster& caster,
                       const Band& band, double tolerance)
    : asset_(asset), grid_(grid), caster_(caster), band_(band), tolerance_(tolerance) {
  list_candidates();
}

std::int64_t CellFitter::bin_of(const Vector3& point) const {
  std::int64_t bin = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const double place = std::floor((point[axis] - grid_.origin[axis]) / grid_.cell_size);
    const std::uint32_t count = grid_.cells[static_cast<std::size_t>(axis)];
    if (!(place >= 0 && place < count)) return nowhere;
    bin = bin * count + static_cast<std::int64_t>(place);
  }
  return bin;
}

/// The grid cells through which the valid surface of one layer passes.
void CellFitter::list_layer(std::uint32_t which, std::uint32_t layer,
                            std::vector<std::uint64_t>& places) const {
  const DistanceMap& map = asset_.maps[which];
  const SupportPlane& plane = asset_.planes[map.plane];
  const int steps = static_cast<int>(std::ceil(4 * map.spacing / grid_.cell_size)) + 1;
  std::vector<std::int64_t> bins;
  for (std::uint32_t row = 0; row + 1 < map.rows; ++row) {
    for (std::uint32_t column = 0; column + 1 < map.columns; ++column) {
      if (!map.cell_valid(layer, column, row)) continue;
      for (int i = 0; i < steps * steps; ++i) {
        MapCell place{column, row, 0.5, 0.5, true};
        if (steps > 1) {
          const std::div_t at = std::div(i, steps);
          place.fx = at.rem / (steps - 1.0);
          place.fy = at.quot / (steps - 1.0);
        }
        const double eta = map.eta0 + (column + place.fx) * map.spacing;
        const double omega = map.omega0 + (row + place.fy) * map.spacing;
        const std::int64_t bin =
            bin_of(reconstructed_surface(plane, eta, omega, height_at(map, layer, place).value));
        if (bin != nowhere && (bins.empty() || bins.back() != bin)) bins.push_back(bin);
      }
    }
  }
  std::sort(bins.begin(), bins.end());
  bins.erase(std::unique(bins.begin(), bins.end()), bins.end());
  const std::uint32_t word = pack_candidate({which, layer});
  for (const std::int64_t bin : bins)
    places.push_back(static_cast<std::uint64_t>(bin) << 32U | word);
}

void CellFitter::list_candidates() {
  std::vector<std::vector<std::uint64_t>> each(asset_.maps.size());
  tbb::parallel_for(std::size_t{0}, each.size(), [&](std::size_t which) {
    for (std::uint32_t layer = 0; layer < asset_.maps[which].layers; ++layer) {
      list_layer(static_cast<std::uint32_t>(which), layer, each[which]);
    }
  });
  std::vector<std::uint64_t> places;
  for (const auto& one : each) places.insert(places.end(), one.begin(), one.end());
  std::sort(places.begin(), places.end());
  const std::size_t count =
      std::size_t{grid_.cells[0]} * std::size_t{grid_.cells[1]} * std::size_t{grid_.cells[2]};
  starts_.assign(count + 1, 0);
  for (const std::uint64_t place : places) ++starts_[(place >> 32U) + 1];
  for (std::size_t i = 0; i < count; ++i) starts_[i + 1] += starts_[i];
  candidates_.reserve(places.size());
  for (const std::uint64_t place : places) {
    candidates_.push_back(static_cast<std::uint32_t>(place & 0xFFFFFFFFU));
  }
}

CellFitter::Sample CellFitter::sample_at(const Vector3& point) const {
  return {point, caster_.closest(point)};
}

CellFitter::Reply CellFitter::ask(std::uint32_t candidate, const Sample& sample) const {
  const auto [which, layer] = unpack_candidate(candidate);
  const DistanceMap& map = asset_.maps[which];
  const MapClosestPoint closest_point =
      closest_on_map(map, layer, asset_.planes[map.plane], sample.point);
  if (!std::isfinite(closest_point.rank)) return {};
  const double side = side_of_crossing(layer);
  return {closest_point.valid, side * closest_point.distance, closest_point.rank, candidate,
          closest_point.cell};
}

Vector3 CellFitter::normal_of(const Reply& reply) const {
  const auto [which, layer] = unpack_candidate(reply.candidate);
  const DistanceMap& map = asset_.maps[which];
  const double side = side_of_crossing(layer);
  return side * normal_at(map, layer, asset_.planes[map.plane], reply.cell);
}

/// True where the reply is acceptable as the answer at the sample.
bool CellFitter::agrees(const Reply& reply, const Sample& sample) const {
  const double allowed = accepted_share * tolerance_;
  const double truth = sample.truth.distance;
  // Beyond the band only the side and the bound are promised.
  if (truth < -band_.max_depth - allowed) return reply.distance < -band_.max_depth + allowed;
  if (truth > band_.margin + allowed) return reply.distance > band_.margin - allowed;
  if (std::abs(reply.distance - truth) > allowed) return false;
  if (std::abs(truth) < directionless_share * tolerance_) return true;
  const Vector3 normal = normal_of(reply);
  if (normal.dot(sample.truth.direction) >= accepted_cosine) return true;
  // Near the medial axis another feature competes. Its closest point lies on the surface all the
  // same.
  const Vector3 closest_point = sample.point - reply.distance * normal;
  return std::abs(caster_.closest(closest_point).distance) <= directionless_share * tolerance_;
}

/// True where a map contains the surface at a point of the surface, within the tolerance along the
/// map's rays.
bool CellFitter::covers(std::uint32_t candidate, const Vector3& closest_point) const {
  const auto [which, layer] = unpack_candidate(candidate);
  const DistanceMap& map = asset_.maps[which];
  const PlaneCoordinates place = project_on_plane(asset_.planes[map.plane], closest_point);
  const MapCell cell = locate(map, place.eta, place.omega);
  const double beyond_eta = place.eta - map.eta0 - (cell.column + cell.fx) * map.spacing;
  const double beyond_omega = place.omega - map.omega0 - (cell.row + cell.fy) * map.spacing;
  return std::abs(beyond_eta) + std::abs(beyond_omega) <= tolerance_ &&
         std::abs(height_at(map, layer, cell).value - place.depth) <= covering_slope * tolerance_;
}

/// The reply of least rank of the chosen maps, which is the one that the servo takes.
CellFitter::Reply CellFitter::answer(const std::vector<std::uint32_t>& chosen,
                                     const Sample& sample) const {
  Reply best;
  for (const std::uint32_t candidate : chosen) {
    const Reply reply = ask(candidate, sample);
    if (reply.rank < best.rank) best = reply;
  }
  return best;
}

bool CellFitter::holds(const std::vector<std::uint32_t>& chosen, const Sample& sample) const {
  const Reply best = answer(chosen, sample);
  return std::isfinite(best.rank) && agrees(best, sample);
}

std::vector<std::uint32_t> CellFitter::candidates_of(const std::vector<Sample>& samples) const {
  std::vector<std::int64_t> bins;
  for (const Sample& sample : samples) {
    const std::int64_t bin = bin_of(sample.truth.closest_point);
    if (bin != nowhere) bins.push_back(bin);
  }
  std::sort(bins.begin(), bins.end());
  bins.erase(std::unique(bins.begin(), bins.end()), bins.end());
  std::vector<std::uint32_t> found;
  for (const std::int64_t bin : bins) {
    const auto first = static_cast<std::ptrdiff_t>(starts_[static_cast<std::size_t>(bin)]);
    const auto last = static_cast<std::ptrdiff_t>(starts_[static_cast<std::size_t>(bin) + 1]);
    found.insert(found.end(), candidates_.begin() + first, candidates_.begin() + last);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// Greedy cover: takes the map that correctly answers most of the samples that are still open, and
/// the more accurate one of equals. Empty where some sample stays open.
std::vector<std::uint32_t> CellFitter::choose(const std::vector<std::uint32_t>& candidates,
                                              const std::vector<Sample>& samples) const {
  struct Option {
    std::uint32_t candidate;
    std::vector<bool> serves;
    double error;
  };
  std::vector<Option> options;
  for (const std::uint32_t candidate : candidates) {
    Option option{candidate, std::vector<bool>(samples.size(), false), 0};
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!covers(candidate, samples[i].truth.closest_point)) continue;
      const Reply reply = ask(candidate, samples[i]);
      if (!reply.valid || !agrees(reply, samples[i])) continue;
      option.serves[i] = true;
      option.error = std::max(option.error, std::abs(reply.distance - samples[i].truth.distance));
    }
    options.push_back(std::move(option));
  }
  std::vector<bool> open(samples.size(), true);
  std::size_t left = samples.size();
  std::vector<std::uint32_t> chosen;
  while (left > 0 && chosen.size() < max_candidates) {
    const Option* best = nullptr;
    std::size_t most = 0;
    for (const Option& option : options) {
      std::size_t count = 0;
      for (std::size_t i = 0; i < open.size(); ++i) count += open[i] && option.serves[i] ? 1 : 0;
      if (count > most || (count == most && count > 0 && option.error < best->error)) {
        best = &option;
        most = count;
      }
    }
    if (best == nullptr) return {};
    chosen.push_back(best->candidate);
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (!open[i] || !best->serves[i]) continue;
      open[i] = false;
      --left;
    }
  }
  if (left > 0) return {};
  return chosen;
}

bool CellFitter::fit(const Vector3& middle, double edge, std::vector<std::uint32_t>& chosen) const {
  std::vector<Sample> samples;
  for (int i = 0; i < lattice * lattice * lattice; ++i) {
    const int row = i / lattice, layer = row / lattice;
    const Vector3 place(i % lattice, row % lattice, layer);
    samples.push_back(
        sample_at(middle + edge * (place / (lattice - 1.0) - Vector3::Constant(0.5))));
  }
  chosen = choose(candidates_of(samples), samples);
  if (!chosen.empty() && std::all_of(samples.begin(), samples.end(),
                                     [&](const Sample& sample) { return holds(chosen, sample); })) {
    return true;
  }
  chosen.clear();
  return false;
}

}  // namespace spm::baker
