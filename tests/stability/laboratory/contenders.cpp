// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/laboratory/contenders.hpp"

namespace spm::stability {

const std::vector<Contender>& all_contenders() {
  static const std::vector<Contender> contenders = [] {
    std::vector<Contender> all{{"paper", {}},         {"distance-field", {}},
                               {"exact-penalty", {}}, {"mesh-proxy", {}},
                               {"spm", {}},           {"proxy", {}}};
    for (const char* method : {"spm", "proxy"}) {
      for (const char* stabilizer : {"damping", "coupling", "passivity", "potential"}) {
        all.push_back({method, stabilizer});
      }
    }
    all.push_back({"proxy", "damping+passivity"});
    all.push_back({"default", {}});
    return all;
  }();
  return contenders;
}

std::string name_of(const Contender& contender) {
  std::string name = contender.method;
  if (!contender.stabilization.empty()) name += "+";
  return name += contender.stabilization;
}

}  // namespace spm::stability
