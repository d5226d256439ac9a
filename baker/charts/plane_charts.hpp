// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/surface/outer_surface.hpp"
#include "common/surface/support_plane.hpp"

namespace spm::baker {

/// A connected piece of the solids' surface without creases, seen from one support plane. Each of
/// its triangles faces the plane.
struct PlaneChart {
  std::uint32_t plane = 0;
  std::vector<std::uint32_t> triangles;  ///< ascending
};

/// The surface in charts (section 2.2): each triangle belongs to the plane that sees it most
/// head-on (Definition 2), and pieces reach on from there over what the plane still sees well.
class PlaneCharts {
 public:
  /// `reach`, m: how far a chart goes on over triangles that other planes see better.
  PlaneCharts(const OuterSurface& surface, std::span<const SupportPlane> planes, double reach);

  [[nodiscard]] std::span<const PlaneChart> charts() const noexcept { return charts_; }
  /// The charts on which a triangle is, ascending.
  [[nodiscard]] std::span<const std::uint32_t> charts_of(std::uint32_t triangle) const noexcept {
    if (triangle + std::size_t{1} >= first_.size()) return {};
    return std::span(members_).subspan(first_[triangle], first_[triangle + 1] - first_[triangle]);
  }

 private:
  std::vector<PlaneChart> charts_;
  std::vector<std::uint32_t> first_, members_;  ///< by triangle
};

}  // namespace spm::baker
