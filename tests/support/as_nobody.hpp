// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <cstdlib>

namespace spm::test {

/// Takes root's rights away while it lives, so that a test of permissions really tries what it
/// names: root may read and write everything. Another user's process stays as it is.
class AsNobody {
 public:
  AsNobody() {
    if (geteuid() != 0) return;
    // access() checks the real user, everything else checks the effective one; the saved user
    // stays root, so that the rights can be restored.
    if (setresgid(nobody, nobody, 0) != 0) return;
    changed_ = true;
    (void)!setresuid(nobody, nobody, 0);
  }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;
  ~AsNobody() {
    // A test program that cannot come back must not go on with other rights than it says.
    if (changed_ && (setresuid(0, 0, 0) != 0 || setresgid(0, 0, 0) != 0)) std::abort();
  }

  /// False where the rights could not be taken away, in a container that forbids it.
  [[nodiscard]] bool works() const { return geteuid() != 0; }

 private:
  static constexpr uid_t nobody = 65534;
  bool changed_ = false;
};

}  // namespace spm::test
