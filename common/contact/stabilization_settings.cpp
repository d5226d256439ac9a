// SPDX-License-Identifier: Apache-2.0
#include "common/contact/stabilization_settings.hpp"

#include <algorithm>

namespace spm {

namespace {

bool set_cure(std::string_view word, CureSettings& cures) noexcept {
  if (word == "damping") {
    cures.damping_share = advised_damping_share;
  } else if (word == "coupling") {
    cures.coupling = advised_coupling;
  } else if (word == "passivity") {
    cures.passivity = true;
  } else if (word == "velocity") {
    cures.velocity = VelocityBy::estimate;
  } else if (word == "difference") {
    cures.velocity = VelocityBy::difference;
  } else if (word == "potential") {
    cures.potential = advised_potential;
  } else if (word == "default") {
    cures = in_loop_of(cures, advised_cures);
  } else {
    return false;
  }
  return true;
}

}  // namespace

bool parse_cures(std::string_view words, CureSettings& cures) noexcept {
  CureSettings read = cures;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find('+'), words.size());
    if (!set_cure(words.substr(0, end), read)) return false;
    if (end + 1 == words.size()) return false;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  cures = read;
  return true;
}

}  // namespace spm
