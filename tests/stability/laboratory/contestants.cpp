// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/contestants.hpp"

#include <algorithm>

#include "baker/base/bake_error.hpp"
#include "servo/force/default_settings.hpp"
#include "servo/scene/force_choice.hpp"

namespace spm::stability {
namespace {

bool is_product(const std::string& method) {
  return method == "spm" || method == "proxy" || method == "default";
}

/// The method that a name stands for, with all of its stabilizers.
Contender resolved(const Contender& contender) {
  if (contender.method != "default") return contender;
  Contender product = default_contender();
  if (!contender.stabilization.empty()) product.stabilization += "+" + contender.stabilization;
  return product;
}

}  // namespace

Contender default_contender() {
  return {servo::to_string(default_method), std::string(default_stabilization_words)};
}

const std::vector<std::string>& contender_methods() {
  static const std::vector<std::string> methods{
      "paper", "distance-field", "exact-penalty", "mesh-proxy", "spm", "proxy", "default"};
  return methods;
}

std::string why_not(const Contender& contender, const StabilityCase& tried) {
  const std::vector<std::string>& methods = contender_methods();
  if (std::find(methods.begin(), methods.end(), contender.method) == methods.end()) {
    return "there is no method '" + contender.method + "'";
  }
  if (!contender.stabilization.empty() && !is_product(contender.method)) {
    return contender.method + " has no stabilizers";
  }
  if (contender.method == "proxy" && contender.stabilization == "potential") {
    return "the force of a proxy is its spring's already";
  }
  const EffectSettings& effects = tried.effects;
  if (is_product(contender.method) || !effects.any()) return {};
  if (contender.method != "paper") return contender.method + " has no effects";
  const bool has_letter = effects.friction_force > 0 || effects.texture_noise > 0;
  if (effects.damping > 0 || (tried.by_the_letter && has_letter)) return {};
  return "paper has no effects but those of its letter";
}

std::unique_ptr<Contestant> make_contestant(const Contender& contender,
                                            const PreparedObject& object,
                                            const StabilityCase& tried,
                                            const RunSettings& settings) {
  const std::string reason = why_not(contender, tried);
  if (!reason.empty()) throw baker::BakeError(ExitCode::usage, tried.name + ": " + reason);
  const double radius = tried.probe_radius, stiffness = settings.stiffness;
  if (contender.method == "paper") return paper_contestant(object, tried, settings);
  if (contender.method == "exact-penalty") {
    return exact_penalty_contestant(object, radius, stiffness);
  }
  if (contender.method == "mesh-proxy") return mesh_proxy_contestant(object, radius, stiffness);
  if (contender.method == "distance-field") {
    return distance_field_contestant(object, radius, stiffness);
  }
  return product_contestant(resolved(contender), object, tried, settings);
}

}  // namespace spm::stability
