// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "tests/bench/base/temporary_folder.hpp"
#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

/// Where a mode puts the assets that it bakes: a folder whose assets later runs take up, with the
/// time that their bake took, or a temporary one. Nothing tells builds of the program apart there.
class BakeFolder {
 public:
  /// Temporary where `kept` is empty. Throws BakeError where no folder can be made.
  explicit BakeFolder(const std::string& kept);

  /// The model's asset without a probe, baked unless it is there. Throws BakeError.
  [[nodiscard]] BakedFile asset(const Model& model, double tolerance) const;

 private:
  std::optional<TemporaryFolder> temporary_;
  std::string path_;
};

}  // namespace spm::bench
