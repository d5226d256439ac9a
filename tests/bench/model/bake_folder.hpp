// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "tests/bench/base/temporary_folder.hpp"
#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

/// The folder, kept or temporary, for the assets that a mode bakes. Later runs reuse the assets of
/// a kept folder, with their bake times. It does not record which build of the program baked them.
class BakeFolder {
 public:
  /// Temporary if `kept` is empty. Throws BakeError if the folder cannot be created.
  explicit BakeFolder(const std::string& kept);

  /// The model's asset without a probe; bakes it if it does not exist yet. Throws BakeError.
  [[nodiscard]] BakedFile asset(const Model& model, double tolerance) const;

 private:
  std::optional<TemporaryFolder> temporary_;
  std::string path_;
};

}  // namespace spm::bench
