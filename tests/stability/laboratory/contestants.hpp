// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "tests/stability/laboratory/contestant.hpp"
#include "tests/stability/laboratory/laboratory.hpp"
#include "tests/stability/objects/prepared_object.hpp"

namespace spm::stability {

/// What `default` stands for: the product's method and stabilizers, chosen by the catalogue.
[[nodiscard]] Contender default_contender();

/// The names of all methods, `default` last.
[[nodiscard]] const std::vector<std::string>& contender_methods();

/// Why a contender is not run on a case, in words; empty where it is run. Effects and stabilizers
/// belong to the product's methods (`paper` has the effects of its own equations): a rival without
/// them would pass their cases without being tested.
[[nodiscard]] std::string why_not(const Contender& contender, const StabilityCase& tried);

/// The object, and all that contenders need of it, must outlive the contestant. The stiffness is
/// the one that the hand feels: a spring in series with a stabilizer's spring is made stiffer to
/// make up for it. Throws BakeError where the name is unknown or `why_not` gives a reason.
[[nodiscard]] std::unique_ptr<Contestant> make_contestant(const Contender& contender,
                                                          const PreparedObject& object,
                                                          const StabilityCase& tried,
                                                          const RunSettings& settings);

// The contestants, one file each. `stiffness` in N/m.

/// The servo's own force code (SceneForce) with a method of the product, on its baked asset. An
/// object that moves is moved by setting its placement, as an application does.
[[nodiscard]] std::unique_ptr<Contestant> product_contestant(const Contender& contender,
                                                             const PreparedObject& object,
                                                             const StabilityCase& tried,
                                                             const RunSettings& settings);

/// The servo's own force code with a whole scene of one object, on its baked asset, which must
/// outlive it. `delay_ticks`: what the servo measured, ticks; 0: nothing.
[[nodiscard]] std::unique_ptr<Contestant> scene_contestant(
    const AssetView& asset, const ForceScene& scene, const StabilityCase& tried,
    const RunSettings& settings, const FeltLimits& limits = {}, double delay_ticks = 0);

/// The paper's equations: those for a point through the servo's own code, those for a ball (eq. 10
/// and 11), which the servo does not offer, by paper_probe_force.
[[nodiscard]] std::unique_ptr<Contestant> paper_contestant(const PreparedObject& object,
                                                           const StabilityCase& tried,
                                                           const RunSettings& settings);

/// Stiffness times depth along the normal of the exact surface, which shares no code with the
/// method; without memory.
[[nodiscard]] std::unique_ptr<Contestant> exact_penalty_contestant(const PreparedObject& object,
                                                                   double probe_radius,
                                                                   double stiffness);

/// A god object on the mesh with force shading off (tests/bench/mesh_proxy). Its proxy stays where
/// it is in the world while the object moves, as CHAI3D's does: an object that moves over it leaves
/// it on the wrong side.
[[nodiscard]] std::unique_ptr<Contestant> mesh_proxy_contestant(const PreparedObject& object,
                                                                double probe_radius,
                                                                double stiffness);

/// Stiffness times depth along the gradient of trilinear distances (see PreparedObject for the
/// lattice); without memory.
[[nodiscard]] std::unique_ptr<Contestant> distance_field_contestant(const PreparedObject& object,
                                                                    double probe_radius,
                                                                    double stiffness);

}  // namespace spm::stability
