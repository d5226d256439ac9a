// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_pages.hpp"

#include <array>
#include <fstream>
#include <sstream>

namespace spm::servo {

namespace {

struct Known {
  const char *name, *file, *type;
};
constexpr std::array<Known, 3> files{{{"view.js", "view.js", "text/javascript; charset=utf-8"},
                                      {"view.css", "view.css", "text/css; charset=utf-8"},
                                      {"icon.svg", "icon.svg", "image/svg+xml"}}};

}  // namespace

Result<std::map<std::string, PageFile>> read_page(const std::string& folder, PageKind kind) {
  std::map<std::string, PageFile> page;
  const Known front{"", kind == PageKind::live ? "index.html" : "recording.html",
                    "text/html; charset=utf-8"};
  for (const Known& known : {front, files[0], files[1], files[2]}) {
    const std::string path = folder + "/" + known.file;
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    if (!file || bytes.str().empty()) {
      return fail(ExitCode::unsupported,
                  path +
                      ": the page of the view is not there: it is built, with npm, by "
                      "scripts/build_page in the checkout");
    }
    page[known.name] = {known.type, bytes.str()};
  }
  return page;
}

}  // namespace spm::servo
