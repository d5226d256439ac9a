// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "common/sixdof/contact_sum.hpp"

namespace spm {

/// A sample that touches, or that a short step may let touch: its spring and the plane of the field
/// at it. A step moves it by along . step off the object; force first, then turn.
struct NearContact {
  std::array<float, 6> along{};  ///< the field's normal, and arm x normal, m
  float distance = 0;            ///< signed, m
  float spring = 0;              ///< N/m, one-sided
};

/// The step to the balance of a wrench that grows weaker along the step, by `stiffness`, with
/// springs of samples that push where they are below their planes: the least energy of all, which
/// is convex, by Newton steps none of which is longer than `longest` (m; turns count by `lever`,
/// m). `wrench` (N, N m) and `stiffness` (positive definite) leave out the springs. Returns m and
/// rad.
[[nodiscard]] Vector6 contact_step(const Vector6& wrench, const Matrix6& stiffness,
                                   std::span<const NearContact> contacts, double longest,
                                   double lever) noexcept;

/// What the springs that touch add to wrench and stiffness before any step.
[[nodiscard]] ContactSum pressed_now(std::span<const NearContact> contacts) noexcept;

}  // namespace spm
