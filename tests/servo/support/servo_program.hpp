// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/servo/support/shape_asset.hpp"

namespace command_test {

using spm::test::TemporaryFolder;

struct Outcome {
  int code = -1;
  std::string out, err;
};

inline std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A started spm-servo, its outputs in files.
class Program {
 public:
  Program(const TemporaryFolder& folder, std::vector<std::string> arguments)
      : out_(folder.file("stdout")), err_(folder.file("stderr")) {
    arguments.insert(arguments.begin(), SPM_SERVO_PROGRAM);
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    child_ = fork();
    if (child_ == 0) {
      if (std::freopen(out_.c_str(), "w", stdout) == nullptr) _exit(127);
      if (std::freopen(err_.c_str(), "w", stderr) == nullptr) _exit(127);
      execv(argv[0], argv.data());
      _exit(127);
    }
  }

  void signal(int number) const { kill(child_, number); }

  [[nodiscard]] Outcome wait() const {
    int status = 0;
    waitpid(child_, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, content(out_), content(err_)};
  }

 private:
  std::string out_, err_;
  pid_t child_ = -1;
};

inline Outcome servo(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  return Program(folder, std::move(arguments)).wait();
}

/// A folder with an asset of either form, and a trajectory over the box's top.
struct Workshop {
  TemporaryFolder folder;
  std::string full = folder.file("full.spm.exr");
  std::string sparse = folder.file("sparse.spm.exr");
  std::string slide = folder.file("slide.txt");
  std::string out = folder.file("out.csv");

  Workshop() {
    spm::test::write(spm::test::box_asset(0.04), full);
    spm::test::write(spm::test::shape_asset(spm::test::box({0.04, 0.04, 0.04})), sparse);
    std::ofstream file(slide);
    for (int i = 0; i < 500; ++i) file << i * 1e-5 << " 0 " << 0.0195 << '\n';
  }

  /// Writes a scene to a file of its own, and returns the file's path.
  [[nodiscard]] std::string scene(const std::string& text) const {
    std::string path = folder.file("scene" + std::to_string(scenes++) + ".toml");
    std::ofstream(path) << text;
    return path;
  }
  mutable int scenes = 0;
};

inline void require_one_sentence(const std::string& err) {
  REQUIRE(err.starts_with("error: "));
  REQUIRE(err.find('\n') == err.size() - 1);
}

}  // namespace command_test
