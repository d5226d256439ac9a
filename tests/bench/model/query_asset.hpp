// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <spm_query.h>

#include <array>
#include <memory>
#include <string>

#include "baker/base/bake_error.hpp"
#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

using QueryAsset = std::shared_ptr<spm_query_asset>;

/// Opens a baked file with libspm_query, as a program outside of the project would. Throws
/// BakeError.
[[nodiscard]] inline QueryAsset open_query_asset(const std::string& path) {
  spm_query_asset* asset = nullptr;
  std::array<char, 512> message{};
  const int code = spm_query_open(path.c_str(), &asset, message.data(), message.size());
  if (code != 0) throw baker::BakeError(static_cast<ExitCode>(code), message.data());
  return {asset, &spm_query_close};
}

/// The same, and notes how long it took.
[[nodiscard]] inline QueryAsset open_query_asset(BakedFile& file) {
  const Clock::time_point start = Clock::now();
  QueryAsset asset = open_query_asset(file.path);
  file.open_seconds = seconds_since(start);
  return asset;
}

}  // namespace spm::bench
