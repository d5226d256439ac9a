// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/pictures/picture.hpp"
#include "common/asset/asset_view.hpp"
#include "formats/asset/asset.hpp"

namespace spm::baker {

/// An asset of a batch for its report.
// NOLINTNEXTLINE(bugprone-exception-escape): a JSON value allocates while it is destroyed.
struct BatchLine {
  nlohmann::ordered_json line;  ///< its line of `batch --json`
  std::string file;             ///< where the baked file lies; may not be there
};

/// A batch of more assets has pictures of the first ones alone: the page would be too large to
/// open.
inline constexpr std::size_t most_thumbnails = 400;

/// The surface as an asset holds it, seen from above at a slant, in grey. `side` in pixels.
[[nodiscard]] Picture thumbnail(const AssetView& asset, const AssetMetadata& metadata,
                                std::uint32_t side);

/// What the page of a batch shows: of each asset its name, state, sizes, errors, seconds, what the
/// cache did, and a picture of the file as it lies there.
[[nodiscard]] nlohmann::ordered_json batch_json(const std::string& manifest,
                                                const std::vector<BatchLine>& lines);

}  // namespace spm::baker
