// SPDX-License-Identifier: Apache-2.0
#include "servo/view/coroutine_end.hpp"

#include <fmt/format.h>

namespace spm::servo {

void EndTold::operator()(const std::exception_ptr& problem) const {
  if (!problem) return;
  try {
    std::rethrow_exception(problem);
  } catch (const std::exception& defect) {
    tell(
        fmt::format("a connection of the view ended by a defect ({}): open the page again, and "
                    "report it as a bug",
                    defect.what()));
  } catch (...) {
    tell(
        "a connection of the view ended by an unknown defect: open the page again, and report it "
        "as a bug");
  }
}

}  // namespace spm::servo
