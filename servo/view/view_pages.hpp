// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>

#include "common/base/error.hpp"

namespace spm::servo {

/// A file of the page.
struct PageFile {
  std::string type;  ///< as HTTP's Content-Type says it
  std::string bytes;
};

/// Which page stands at the address itself.
enum class PageKind { live, recording };

/// The files of the built page, by their names ("" is the page itself). Read once: what is served
/// cannot lie outside of the folder. Errors: unsupported, where the page was not built, with the
/// cure.
[[nodiscard]] Result<std::map<std::string, PageFile>> read_page(const std::string& folder,
                                                                PageKind kind);

}  // namespace spm::servo
