// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/model/model.hpp"

namespace spm::bench {

/// A mesh from the project's table, and its tolerance in that table, metres.
struct KnownMesh {
  const char* name;
  double tolerance;
};

/// All seven of them.
[[nodiscard]] const std::vector<KnownMesh>& known_meshes();

/// The folder that SPM_SHARED names, or else the one beside the checkout. Throws BakeError if
/// there is none.
[[nodiscard]] std::string shared_folder();

/// The known meshes in the shared folder; `tolerance` replaces their own. Throws BakeError.
[[nodiscard]] std::vector<ModelSource> sources_of(const std::vector<KnownMesh>& meshes,
                                                  std::optional<double> tolerance);

/// Mesh files as the command line names them. The default tolerance is a thousandth of the
/// diagonal.
[[nodiscard]] std::vector<ModelSource> sources_of(const std::vector<std::string>& paths,
                                                  std::optional<double> tolerance);

}  // namespace spm::bench
