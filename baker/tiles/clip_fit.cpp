// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/tiles/clip_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace spm::baker {

namespace {

constexpr int side = 5;         ///< places along the cell that are tried first
constexpr int directions = 16;  ///< directions of the line that are tried
constexpr int scans = 5;        ///< lines across the crease along which the crease is searched
constexpr int halvings = 6;
/// A line that keeps fewer of the places than this is not worth the word that stores it.
constexpr int min_kept = 3;

struct Place {
  double x, y;
  bool on;
};

double median(double* values, std::size_t count) {
  std::nth_element(values, values + count / 2, values + count);
  return values[count / 2];
}

/// Where the surface ends on the scan line t along (a, b) through the cell; empty where it does not
/// end.
std::optional<double> layer_end(double a, double b, double t, double x, double y,
                                const std::function<bool(double, double)>& on_layer) {
  // The part of the line within the cell.
  double from = -1, to = 1;
  const auto narrow = [&](double start, double slope) {
    if (std::abs(slope) < 1e-9) {
      if (std::abs(start) > 0.5) to = -1, from = 1;
      return;
    }
    const double one = (-0.5 - start) / slope, other = (0.5 - start) / slope;
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
  };
  narrow(-t * b, a);
  narrow(t * a, b);
  if (!(to - from > 0.1)) return std::nullopt;
  const auto inside = [&](double s) { return on_layer(x + s * a - t * b, y + s * b + t * a); };
  if (!inside(from)) return std::nullopt;
  double good = from, bad = to;
  constexpr int steps = 6;
  for (int step = 1; step <= steps; ++step) {
    const double s = from + (to - from) * step / steps;
    if (!inside(s)) {
      bad = s;
      break;
    }
    good = s;
    if (step == steps) return std::nullopt;
  }
  for (int halving = 0; halving < halvings; ++halving) {
    const double s = (good + bad) / 2;
    (inside(s) ? good : bad) = s;
  }
  return good;
}

}  // namespace

std::optional<Clip> fit_clip(double x, double y,
                             const std::function<bool(double, double)>& on_layer) {
  std::array<Place, side * side> places{};
  for (int k = 0; k < side * side; ++k) {
    const double px = (k % side) / (side - 1.0) - 0.5, py = (k / side) / (side - 1.0) - 0.5;
    places[static_cast<std::size_t>(k)] = {px, py, on_layer(x + px, y + py)};
  }
  int most = 0;
  double best_a = 1, best_b = 0;
  for (int k = 0; k < directions; ++k) {
    const double angle = 2 * std::numbers::pi * k / directions;
    const double a = std::cos(angle), b = std::sin(angle);
    double nearest_off = std::numeric_limits<double>::infinity();
    for (const Place& place : places) {
      if (!place.on) nearest_off = std::min(nearest_off, a * place.x + b * place.y);
    }
    int kept = 0;
    for (const Place& place : places) {
      kept += place.on && a * place.x + b * place.y < nearest_off - 1e-9 ? 1 : 0;
    }
    if (kept > most) {
      most = kept;
      best_a = a;
      best_b = b;
    }
  }
  if (most < min_kept) return std::nullopt;

  // Where the surface ends along lines across the crease, found by halving. The clip line runs
  // through these ends.
  struct End {
    double along, end;
  };
  std::array<End, scans> ends{};
  std::size_t found = 0;
  for (int k = 0; k < scans; ++k) {
    const double t = 0.96 * (k / (scans - 1.0) - 0.5);
    if (const std::optional<double> end = layer_end(best_a, best_b, t, x, y, on_layer)) {
      ends[found++] = {t, *end};
    }
  }
  if (found < 2) return std::nullopt;
  // The line of Theil and Sen: an end that belongs to another crease does not turn it.
  std::array<double, scans*(scans - 1) / 2> slopes{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < found; ++i) {
    for (std::size_t j = i + 1; j < found; ++j) {
      slopes[count++] = (ends[j].end - ends[i].end) / (ends[j].along - ends[i].along);
    }
  }
  const double slope = median(slopes.data(), count);
  std::array<double, scans> offsets{};
  for (std::size_t i = 0; i < found; ++i) offsets[i] = ends[i].end - slope * ends[i].along;
  const double offset = median(offsets.data(), found);
  // s - slope t <= offset, with s = a x + b y and t = a y - b x.
  double a = best_a + slope * best_b, b = best_b - slope * best_a, c = offset;
  const double scale = 127 / std::max(std::abs(a), std::abs(b));
  a = std::round(a * scale);
  b = std::round(b * scale);
  c = std::floor(c * scale * 128) / 128;
  if (c <= -0.5 * (std::abs(a) + std::abs(b))) return std::nullopt;
  return Clip{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
}

}  // namespace spm::baker
