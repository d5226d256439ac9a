// SPDX-License-Identifier: Apache-2.0
#include "common/contact/stabilization_settings.hpp"

#include <algorithm>

namespace spm {

namespace {

bool set_stabilization(std::string_view word, StabilizationSettings& stabilization) noexcept {
  if (word == "damping") {
    stabilization.damping_share = recommended_damping_share;
  } else if (word == "coupling") {
    stabilization.coupling = recommended_coupling;
  } else if (word == "passivity") {
    stabilization.passivity = true;
  } else if (word == "velocity") {
    stabilization.velocity = VelocityMethod::estimate;
  } else if (word == "difference") {
    stabilization.velocity = VelocityMethod::difference;
  } else if (word == "potential") {
    stabilization.potential = recommended_potential;
  } else if (word == "recommended") {
    stabilization = in_loop_of(stabilization, recommended_stabilization);
  } else {
    return false;
  }
  return true;
}

}  // namespace

bool parse_stabilization(std::string_view words, StabilizationSettings& stabilization) noexcept {
  StabilizationSettings read = stabilization;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find('+'), words.size());
    if (!set_stabilization(words.substr(0, end), read)) return false;
    if (end + 1 == words.size()) return false;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  stabilization = read;
  return true;
}

}  // namespace spm
