// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/base/machine.hpp"

#include <openvdb/version.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <embree/rays.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace spm::bench {
namespace {

/// The value of the first line of a file that begins with `key`; empty where there is none.
std::string value_of(const char* file, const std::string& key, char separator) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    const std::size_t start = line.find(separator);
    if (start == std::string::npos) return {};
    std::string value = line.substr(start + 1);
    value.erase(0, value.find_first_not_of(" \t\""));
    value.erase(value.find_last_not_of(" \t\"") + 1);
    return value;
  }
  return {};
}

std::string kernel() {
  utsname names{};
  if (uname(&names) != 0) return {};
  // Without what the one who built it added to the version.
  const std::string release = names.release;
  return std::string(names.sysname) + " " + release.substr(0, release.find('-'));
}

/// The words of this process's command line. A word that is a path keeps its last part only.
std::string command() {
  std::ifstream stream("/proc/self/cmdline");
  std::string text;
  for (std::string word; std::getline(stream, word, '\0');) {
    if (!text.empty()) text += ' ';
    text += word.find('/') == std::string::npos ? word
                                                : std::filesystem::path(word).filename().string();
  }
  return text;
}

nlohmann::ordered_json machine_json() {
  nlohmann::ordered_json json;
  json["processor"] = value_of("/proc/cpuinfo", "model name", ':');
  json["cores"] = std::thread::hardware_concurrency();
  json["memory_bytes"] = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                         static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  json["system"] = value_of("/etc/os-release", "PRETTY_NAME", '=');
  json["kernel"] = kernel();
  json["compiler"] = "g++ " __VERSION__;
  json["build"] = SPM_BUILD_TYPE;
  json["embree"] = RTC_VERSION_STRING;
  json["openvdb"] = OPENVDB_LIBRARY_VERSION_STRING;
  json["spm"] = SPM_VERSION;
  return json;
}

}  // namespace

nlohmann::ordered_json made_json() { return {{"machine", machine_json()}, {"command", command()}}; }

}  // namespace spm::bench
