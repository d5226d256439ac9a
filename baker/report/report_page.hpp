// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "baker/pictures/picture.hpp"

namespace spm::baker {

/// Bytes as text, RFC 4648.
[[nodiscard]] std::string base64(std::string_view bytes);

/// Bytes in zlib's form, RFC 1950; the same bytes give the same. Throws BakeError internal.
[[nodiscard]] std::string deflated(std::string_view bytes);

/// A picture as an address that holds it, with 64 steps of each colour. Throws BakeError internal.
[[nodiscard]] std::string data_url(Picture picture);

/// The page with a report's data in it, whole: it loads nothing. `page` is the built page. Text in
/// the data cannot end the element that holds it. Throws BakeError internal where the page has no
/// place for data.
[[nodiscard]] std::string filled_page(const std::string& page, const nlohmann::ordered_json& data);

/// The built pages: of one asset, and of a batch.
enum class ReportPage { asset, batch };

/// A built page beside this program. Throws BakeError unsupported, with the cure, where it was not
/// built.
[[nodiscard]] std::string built_page(ReportPage page);

}  // namespace spm::baker
