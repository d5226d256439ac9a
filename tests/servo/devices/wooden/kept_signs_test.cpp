// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/wooden/kept_signs.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace kept_signs_test {

using namespace spm::servo;

namespace {

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "kept-signs-XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] std::string inside() const { return path_ + "/state/woodenhaptics"; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

const WoodenBoard board{"0123456789", "woody2019", WoodenProtocol::v2};
const WoodenSigns signs{{1, -1, 1, -1, 1, 1}, {1, -1, 1}};

}  // namespace

TEST_CASE("Signs that are kept are those of the next start, for that board alone") {
  const Folder folder;
  CHECK_FALSE(kept_signs(folder.inside(), board));
  REQUIRE(keep_signs(folder.inside(), board, signs));
  CHECK(kept_signs(folder.inside(), board) == signs);
  CHECK_FALSE(kept_signs(folder.inside(), {"0123456788", board.model, board.protocol}));
  CHECK_FALSE(kept_signs(folder.inside(), {board.serial, "vintage", board.protocol}));
  CHECK_FALSE(kept_signs(folder.inside(), {board.serial, board.model, WoodenProtocol::v1}));
  const WoodenSigns others{{-1, -1, -1, 1, 1, 1}, {-1, -1, -1}};
  REQUIRE(keep_signs(folder.inside(), board, others));
  CHECK(kept_signs(folder.inside(), board) == others);
}

TEST_CASE("A serial number names no file beside the folder") {
  const Folder folder;
  const WoodenBoard odd{"../../x/.. \n", board.model, board.protocol};
  REQUIRE(keep_signs(folder.inside(), odd, signs));
  CHECK(kept_signs(folder.inside(), odd) == signs);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
    if (entry.is_regular_file()) CHECK(entry.path().parent_path() == folder.inside());
  }
}

TEST_CASE("A damaged file confirms nothing") {
  const Folder folder;
  REQUIRE(keep_signs(folder.inside(), board, signs));
  const std::string path = std::filesystem::directory_iterator(folder.inside())->path().string();
  for (const char* text : {"", "woody2019", "woody2019 v2 +-+", "woody2019 v2 +-+-++ +-",
                           "woody2019 v2 +-+-+0 +-+", "woody2019 v2 +-+-++ +-+ x"}) {
    CAPTURE(text);
    std::ofstream(path) << text;
    CHECK_FALSE(kept_signs(folder.inside(), board));
  }
}

TEST_CASE(
    "Signs of a board without a number, or without a folder, are not kept, and that is told") {
  const Folder folder;
  const auto unnumbered = keep_signs(folder.inside(), {"", board.model, board.protocol}, signs);
  REQUIRE_FALSE(unnumbered);
  CHECK_THAT(unnumbered.error().message, Catch::Contains("no serial number"));
  const auto homeless = keep_signs("", board, signs);
  REQUIRE_FALSE(homeless);
  CHECK_THAT(homeless.error().message, Catch::Contains("XDG_STATE_HOME"));
  std::ofstream(folder.path() + "/state") << "a file";
  const auto unwritable = keep_signs(folder.inside(), board, signs);
  REQUIRE_FALSE(unwritable);
  CHECK_THAT(unwritable.error().message, Catch::Contains("cannot be written"));
  CHECK_FALSE(kept_signs(folder.inside(), board));
}

}  // namespace kept_signs_test
