// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/catalogue/catalogue.hpp"

#include <iterator>

#include "tests/stability/objects/prepared_object.hpp"

namespace spm::stability {

std::vector<StabilityCase> whole_catalogue() {
  std::vector<StabilityCase> all;
  for (const auto& theme :
       {wall_cases, thin_cases, groove_cases, effect_cases, moving_cases, loop_cases, mesh_cases}) {
    std::vector<StabilityCase> cases = theme();
    all.insert(all.end(), std::make_move_iterator(cases.begin()),
               std::make_move_iterator(cases.end()));
  }
  return all;
}

std::vector<StabilityCase> catalogue() {
  std::vector<StabilityCase> all = whole_catalogue();
  std::erase_if(all, [](const StabilityCase& one) { return !why_unprepared(one).empty(); });
  return all;
}

std::vector<std::string> left_out_cases() {
  std::vector<std::string> words;
  for (const StabilityCase& one : whole_catalogue()) {
    const std::string why = why_unprepared(one);
    if (why.empty()) continue;
    std::string sentence = one.name;
    sentence += ": ";
    sentence += why;
    words.push_back(std::move(sentence));
  }
  return words;
}

}  // namespace spm::stability
