// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>

namespace spm::test {

/// Exit code of a test program in which a test was skipped and none failed. ctest counts such a
/// test as skipped and names it (SKIP_RETURN_CODE in tests/ctest.cmake).
inline constexpr int skip_code = 77;

/// Prints `SKIPPED: why` and makes the program end with `skip_code` unless a test fails.
void note_skip(const std::string& why);

}  // namespace spm::test

/// Leaves a test case that cannot run on this machine. Takes anything that a stream takes.
#define SPM_SKIP(why)                          \
  do {                                         \
    std::ostringstream spm_skip_text;          \
    spm_skip_text << why;                      \
    spm::test::note_skip(spm_skip_text.str()); \
    return;                                    \
  } while (false)
