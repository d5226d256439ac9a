// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/field/corner_distances.hpp"

#include <cstddef>

// Highway compiles what follows once for each kind of processor, by including this file again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "baker/field/corner_distances.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as it must be.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace spm::baker::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t corners = 8;
// Products and sums are not fused, so that every processor gives the same bits.
using Lanes = hn::CappedTag<double, corners>;
using Doubles = hn::Vec<Lanes>;

/// Where the corners of a cube lie from its middle, along each axis.
alignas(64) constexpr std::array<std::array<double, corners>, 3> corner_signs{
    {{-1, 1, -1, 1, -1, 1, -1, 1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, -1, -1, -1, 1, 1, 1, 1}}};

/// Vectors to the corners of a cube from the k-th on.
struct Vectors {
  Doubles x, y, z;

  [[nodiscard]] HWY_INLINE Doubles dot(const Vector3& v) const {
    const Lanes lanes;
    return hn::Add(hn::Add(hn::Mul(x, hn::Set(lanes, v[0])), hn::Mul(y, hn::Set(lanes, v[1]))),
                   hn::Mul(z, hn::Set(lanes, v[2])));
  }
  [[nodiscard]] HWY_INLINE Doubles square() const {
    return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  }
  [[nodiscard]] HWY_INLINE Vectors less(Doubles share, const Vector3& along) const {
    const Lanes lanes;
    return {hn::Sub(x, hn::Mul(share, hn::Set(lanes, along[0]))),
            hn::Sub(y, hn::Mul(share, hn::Set(lanes, along[1]))),
            hn::Sub(z, hn::Mul(share, hn::Set(lanes, along[2])))};
  }
};

/// How far the corners lie from the middle along an axis, where a face does so by `rise`.
HWY_INLINE Doubles rise_along(std::size_t k, int axis, double rise) {
  const Lanes lanes;
  return hn::Mul(hn::Load(lanes, corner_signs[static_cast<std::size_t>(axis)].data() + k),
                 hn::Set(lanes, rise));
}

HWY_INLINE Doubles linear_from(std::size_t k, double value, const Vector3& rise) {
  return hn::Add(hn::Add(hn::Set(Lanes(), value), rise_along(k, 0, rise[0])),
                 hn::Add(rise_along(k, 1, rise[1]), rise_along(k, 2, rise[2])));
}

HWY_INLINE Vectors vectors_from(std::size_t k, const Vector3& to_middle, double half) {
  const auto along = [&](int axis) {
    return hn::Add(hn::Set(Lanes(), to_middle[axis]), rise_along(k, axis, half));
  };
  return {along(0), along(1), along(2)};
}

/// Vectors to the corners from the closest places of a part of the triangle.
struct Away {
  Vectors vectors;
  Doubles squares;

  HWY_INLINE explicit Away(const Vectors& from) : vectors(from), squares(from.square()) {}
  template <class Mask>
  HWY_INLINE void take(const Mask& mask, const Away& other) {
    vectors = {hn::IfThenElse(mask, other.vectors.x, vectors.x),
               hn::IfThenElse(mask, other.vectors.y, vectors.y),
               hn::IfThenElse(mask, other.vectors.z, vectors.z)};
    squares = hn::IfThenElse(mask, other.squares, squares);
  }
  HWY_INLINE void take_nearer(const Away& other) { take(hn::Lt(other.squares, squares), other); }
};

HWY_INLINE Away away_from_segment(const Vectors& from_start, const Vector3& along,
                                  double per_square) {
  const Lanes lanes;
  const Doubles share =
      hn::Min(hn::Max(hn::Mul(from_start.dot(along), hn::Set(lanes, per_square)), hn::Zero(lanes)),
              hn::Set(lanes, 1.0));
  return Away(from_start.less(share, along));
}

/// From the k-th corner of the cube on.
HWY_INLINE Away away_from(const std::array<Vector3, 3>& triangle, const TriangleShares& shares,
                          const Vector3& middle, double half, std::size_t k) {
  const Lanes lanes;
  const Vector3 ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0], bc = ac - ab;
  const Vectors from_a = vectors_from(k, middle - triangle[0], half);
  const Vectors from_b = vectors_from(k, middle - triangle[1], half);
  Away nearest = away_from_segment(from_a, ab, shares.per_ab);
  nearest.take_nearer(away_from_segment(from_a, ac, shares.per_ac));
  nearest.take_nearer(away_from_segment(from_b, bc, shares.per_bc));
  if (!shares.flat) {
    // Barycentric coordinates of the projections.
    const Doubles weight_b = from_a.dot(shares.to_b), weight_c = from_a.dot(shares.to_c);
    const Doubles weight_a = hn::Sub(hn::Sub(hn::Set(lanes, 1.0), weight_b), weight_c);
    const auto over = hn::Ge(hn::Min(hn::Min(weight_b, weight_c), weight_a), hn::Zero(lanes));
    const Away face(from_a.less(weight_b, ab).less(weight_c, ac));
    nearest.take(hn::And(over, hn::Lt(face.squares, nearest.squares)), face);
  }
  return nearest;
}

void find_distances(const std::array<Vector3, 3>& triangle, const TriangleShares& shares,
                    const Vector3& middle, double half, double* distances) {
  const Lanes lanes;
  for (std::size_t k = 0; k < corners; k += hn::Lanes(lanes)) {
    const Away nearest = away_from(triangle, shares, middle, half, k);
    hn::StoreU(hn::Sqrt(nearest.squares), lanes, distances + k);
  }
}

void find_tangents(const std::array<Vector3, 3>& triangle, const TriangleShares& shares,
                   const Vector3& middle, double half, CornerTangents& found) {
  const Lanes lanes;
  for (std::size_t k = 0; k < corners; k += hn::Lanes(lanes)) {
    const Away nearest = away_from(triangle, shares, middle, half, k);
    const Doubles distances = hn::Sqrt(nearest.squares);
    const Doubles per = hn::IfThenElseZero(hn::Gt(distances, hn::Zero(lanes)),
                                           hn::Div(hn::Set(lanes, 1.0), distances));
    hn::StoreU(distances, lanes, found.distances.data() + k);
    hn::StoreU(hn::Mul(per, nearest.vectors.x), lanes, found.tangents[0].data() + k);
    hn::StoreU(hn::Mul(per, nearest.vectors.y), lanes, found.tangents[1].data() + k);
    hn::StoreU(hn::Mul(per, nearest.vectors.z), lanes, found.tangents[2].data() + k);
  }
}

void find_which_above(std::span<const LinearFunction> functions,
                      std::span<const CornerValues> values, std::uint8_t* above) {
  const Lanes lanes;
  for (std::size_t i = 0; i < functions.size(); ++i) {
    alignas(64) std::array<double, corners> at{};
    for (std::size_t k = 0; k < corners; k += hn::Lanes(lanes)) {
      hn::Store(linear_from(k, functions[i].value, functions[i].rise), lanes, at.data() + k);
    }
    above[i] = 0;
    for (std::size_t v = 0; v < values.size() && above[i] == 0; ++v) {
      bool all = true;
      for (std::size_t k = 0; k < corners && all; k += hn::Lanes(lanes)) {
        all = hn::AllTrue(
            lanes, hn::Gt(hn::Load(lanes, at.data() + k), hn::LoadU(lanes, values[v].data() + k)));
      }
      above[i] = all ? 1 : 0;
    }
  }
}

}  // namespace spm::baker::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spm::baker {

HWY_EXPORT(find_distances);
HWY_EXPORT(find_tangents);
HWY_EXPORT(find_which_above);

CornerValues linear_at_corners(double value, const Vector3& rise) {
  CornerValues values;
  values << value - rise[0] - rise[1] - rise[2], value + rise[0] - rise[1] - rise[2],
      value - rise[0] + rise[1] - rise[2], value + rise[0] + rise[1] - rise[2],
      value - rise[0] - rise[1] + rise[2], value + rise[0] - rise[1] + rise[2],
      value - rise[0] + rise[1] + rise[2], value + rise[0] + rise[1] + rise[2];
  return values;
}

TriangleShares shares_of(const std::array<Vector3, 3>& triangle) {
  const auto per = [](double number) { return number > 0 ? 1 / number : 0; };
  const Vector3 ab = triangle[1] - triangle[0], ac = triangle[2] - triangle[0], bc = ac - ab;
  const Vector3 normal = ab.cross(ac);
  const double per_area = per(normal.squaredNorm());
  return {per_area * ac.cross(normal), per_area * normal.cross(ab), per(ab.squaredNorm()),
          per(ac.squaredNorm()),       per(bc.squaredNorm()),       !(per_area > 0)};
}

CornerValues corner_distances(const std::array<Vector3, 3>& triangle, const TriangleShares& shares,
                              const Vector3& middle, double half) {
  CornerValues distances;
  HWY_DYNAMIC_DISPATCH(find_distances)(triangle, shares, middle, half, distances.data());
  return distances;
}

CornerTangents corner_tangents(const std::array<Vector3, 3>& triangle, const TriangleShares& shares,
                               const Vector3& middle, double half) {
  CornerTangents found;
  HWY_DYNAMIC_DISPATCH(find_tangents)(triangle, shares, middle, half, found);
  return found;
}

void find_above(std::span<const LinearFunction> functions, std::span<const CornerValues> values,
                std::vector<std::uint8_t>& above) {
  above.resize(functions.size());
  HWY_DYNAMIC_DISPATCH(find_which_above)(functions, values, above.data());
}

}  // namespace spm::baker
#endif
