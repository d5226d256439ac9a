// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/full/cell_fit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/surface/closest_on_map.hpp"

namespace spm::baker {

namespace {

/// Sample points of a cell along an axis, corners included.
constexpr int lattice = 4;
/// How often a choice may be made again with the points where it failed.
constexpr int choosing_rounds = 4;
/// Spacing of the surface points at which a choice is tried, as a share of the diagonal.
constexpr double probe_spacing_share = 1.0 / 350;
/// How far surface points on a crease are moved away from it, as a share of the diagonal: less than
/// the finest cell of a map.
constexpr double probe_inset_share = 3e-4;
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
                       const Band& band, double tolerance, std::uint64_t seed)
    : asset_(asset), grid_(grid), caster_(caster), band_(band), tolerance_(tolerance) {
  list_candidates();
  list_probes(seed);
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
          place.fx = static_cast<double>(i % steps) / (steps - 1);
          place.fy = static_cast<double>(i / steps) / (steps - 1);
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

/// Surface points, listed by the grid cell in which they lie, in a fixed order.
void CellFitter::list_probes(std::uint64_t seed) {
  const std::vector<SurfacePoint> points =
      surface_points(caster_, probe_spacing_share * caster_.diagonal(),
                     probe_inset_share * caster_.diagonal(), seed);
  const std::size_t count = starts_.size() - 1;
  std::vector<std::int64_t> bins(points.size());
  probe_starts_.assign(count + 1, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    bins[i] = bin_of(points[i].point);
    if (bins[i] != nowhere) ++probe_starts_[static_cast<std::size_t>(bins[i]) + 1];
  }
  for (std::size_t i = 0; i < count; ++i) probe_starts_[i + 1] += probe_starts_[i];
  probes_.resize(probe_starts_.back());
  std::vector<std::uint64_t> next(probe_starts_.begin(), probe_starts_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (bins[i] == nowhere) continue;
    probes_[next[static_cast<std::size_t>(bins[i])]++] = {points[i].point,
                                                          caster_.normal(points[i].triangle), 0};
  }
}

/// For each surface point whose normal passes through a cube within the band: the end of its path
/// through the cube that is nearest to the point. If any point of the path has its closest point
/// there, that end has.
std::vector<Probe> CellFitter::probes_through(const Vector3& middle, double edge) const {
  const double search_radius = std::max(band_.max_depth, band_.margin) + edge / 2;
  std::array<std::int64_t, 3> low{}, high{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const double last = grid_.cells[k] - 1.0;
    const double place = (middle[axis] - grid_.origin[axis]) / grid_.cell_size;
    low[k] = static_cast<std::int64_t>(
        std::clamp(std::floor(place - search_radius / grid_.cell_size), 0.0, last));
    high[k] = static_cast<std::int64_t>(
        std::clamp(std::floor(place + search_radius / grid_.cell_size), 0.0, last));
  }
  std::vector<Probe> found;
  for (std::int64_t z = low[2]; z <= high[2]; ++z) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      const auto row = static_cast<std::size_t>((z * grid_.cells[1] + y) * grid_.cells[0]);
      const std::uint64_t end = probe_starts_[row + static_cast<std::size_t>(high[0]) + 1];
      for (std::uint64_t i = probe_starts_[row + static_cast<std::size_t>(low[0])]; i < end; ++i) {
        double from = -band_.max_depth, to = band_.margin;
        for (int axis = 0; axis < 3; ++axis) {
          const double offset = middle[axis] - probes_[i].point[axis];
          const double slope = probes_[i].normal[axis];
          const double a = (offset - edge / 2) / slope, b = (offset + edge / 2) / slope;
          // A normal along the cube's side gives infinities of the right signs, or NaN on the side.
          from = std::fmax(from, std::fmin(a, b));
          to = std::fmin(to, std::fmax(a, b));
        }
        if (!(from < to)) continue;
        const Vector3& normal = probes_[i].normal;
        const double nearest = std::clamp(0.0, from + 0.02 * (to - from), to - 0.02 * (to - from));
        found.push_back({probes_[i].point + nearest * normal, normal, nearest});
      }
    }
  }
  return found;
}

/// True where the chosen maps find the probe's own surface point from its trial point. Then the
/// true closest point need not be computed, since a closer one has a probe of its own.
bool CellFitter::finds(const std::vector<std::uint32_t>& chosen, const Probe& probe) const {
  const Reply reply = answer(chosen, {probe.point, {}});
  return reply.valid &&
         std::abs(reply.distance - probe.height) <= directionless_share * tolerance_ &&
         normal_of(reply).dot(probe.normal) >= accepted_cosine;
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

bool CellFitter::holds_at(const std::vector<std::uint32_t>& chosen, const Probe& probe) const {
  return finds(chosen, probe) || holds(chosen, sample_at(probe.point));
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

bool CellFitter::fit(const Vector3& middle, double edge, std::span<const Vector3> more,
                     std::vector<std::uint32_t>& chosen) const {
  std::vector<Sample> samples;
  for (int i = 0; i < lattice * lattice * lattice; ++i) {
    const Vector3 place(i % lattice, i / lattice % lattice, i / (lattice * lattice));
    samples.push_back(
        sample_at(middle + edge * (place / (lattice - 1.0) - Vector3::Constant(0.5))));
  }
  for (const Vector3& point : more) samples.push_back(sample_at(point));
  const std::vector<Probe> probes = probes_through(middle, edge);
  for (int round = 0; round < choosing_rounds; ++round) {
    chosen = choose(candidates_of(samples), samples);
    if (chosen.empty()) return false;
    if (!std::all_of(samples.begin(), samples.end(),
                     [&](const Sample& sample) { return holds(chosen, sample); })) {
      break;
    }
    const std::size_t before = samples.size();
    for (const Probe& probe : probes) {
      if (finds(chosen, probe)) continue;
      const Sample sample = sample_at(probe.point);
      if (!holds(chosen, sample)) samples.push_back(sample);
    }
    if (samples.size() == before) return true;
  }
  chosen.clear();
  return false;
}

}  // namespace spm::baker
