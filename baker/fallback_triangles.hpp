// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/cast.hpp"
#include "baker/surface_proof.hpp"
#include "formats/asset.hpp"

namespace spm::baker {

/// Every triangle that the fallback of a `sparse` asset may list, as the file stores it: pieces of
/// surface that no tile stands for, then all triangles of the surface, then its caps. Stored in 16
/// bits a coordinate where the tolerance allows, else as floats.
class FallbackTriangles {
 public:
  FallbackTriangles(const Caster& caster, const std::vector<SurfacePiece>& pieces,
                    double tolerance);

  /// How far the rounding of triangles may move them, m: the proof leaves as much room.
  [[nodiscard]] static double rounding(double tolerance);

  [[nodiscard]] std::uint32_t pieces() const { return pieces_; }
  /// The number of a triangle of the caster.
  [[nodiscard]] std::uint32_t of_caster(std::uint32_t triangle) const { return pieces_ + triangle; }
  /// As a list names it: twice the number, plus one for a cap.
  [[nodiscard]] std::uint32_t word(std::uint32_t number) const {
    return number << 1U | (number >= first_cap_ ? 1U : 0U);
  }
  /// True where the rounding took a triangle's direction: then it is left out, since the ones
  /// beside it lie as near.
  [[nodiscard]] bool lost(std::uint32_t number) const;
  [[nodiscard]] std::array<Vector3, 3> corners(std::uint32_t number) const;

  /// Lets a view read all of them by their numbers here.
  void show(AssetView& view) const;
  /// Appends one to an asset, in the same form.
  void append(std::uint32_t number, Asset& asset) const;
  /// Sets the form's origin and step.
  void describe(Asset& asset) const;

 private:
  std::uint32_t pieces_ = 0;
  std::uint32_t first_cap_ = 0;
  Vector3 origin_ = Vector3::Zero();
  double step_ = 0;  ///< 0 where stored as floats
  std::vector<std::uint16_t> small_;
  std::vector<float> large_;

  void add(const std::array<Vector3, 3>& corners);
};

}  // namespace spm::baker
