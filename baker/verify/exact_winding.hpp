// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "baker/mesh/mesh.hpp"
#include "common/base/vector.hpp"

namespace spm::baker {

/// Winding number of a mesh's closed solids: how often a way out leaves them more than it enters
/// them, by exact predicates on the doubles as they are.
class ExactWinding {
 public:
  explicit ExactWinding(const Mesh& mesh);
  ~ExactWinding();
  ExactWinding(const ExactWinding&) = delete;
  ExactWinding& operator=(const ExactWinding&) = delete;

  /// A point on the surface takes the value of one of its sides. Thread-safe.
  [[nodiscard]] int at(const Vector3& point) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace spm::baker
