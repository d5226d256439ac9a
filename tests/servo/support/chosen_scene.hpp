// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <string>

#include "servo/scene/force_choice.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace spm::test {

/// What the loop is given for a scene's text and the options of the command line.
inline Result<servo::ForceChoice> choose(const std::string& text,
                                         servo::ForceOptions options = {}) {
  const TemporaryFolder folder;
  options.scene = folder.file("scene.toml");
  std::ofstream(options.scene) << text;
  return servo::choose_forces(options);
}

}  // namespace spm::test
