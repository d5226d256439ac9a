// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/report_page.hpp"

#include <openssl/evp.h>
#include <zlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "baker/base/bake_error.hpp"

namespace spm::baker {

namespace {

/// Stands in the page where the data goes.
constexpr std::string_view mark = "\"SPM_REPORT_DATA\"";

}  // namespace

std::string base64(std::string_view bytes) {
  // Four characters for three bytes, and a zero that the library writes behind them.
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                     reinterpret_cast<const unsigned char*>(bytes.data()),
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
  return text;
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  const int code = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                             reinterpret_cast<const Bytef*>(bytes.data()),
                             static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION);
  if (code != Z_OK) {
    throw BakeError(ExitCode::internal, "zlib could not pack the report; report it as a bug");
  }
  packed.resize(size);
  return packed;
}

std::string data_url(Picture picture) {
  // The two lowest bits of colours are noise to a packer, and nothing to the eye.
  for (std::uint8_t& part : picture.pixels) {
    part = static_cast<std::uint8_t>((part & 0xFCU) | (part >> 6U));
  }
  const Result<std::string> png = to_png(picture);
  if (!png) throw BakeError(png.error().code, png.error().message);
  return "data:image/png;base64," + base64(*png);
}

std::string filled_page(const std::string& page, const nlohmann::ordered_json& data) {
  const std::size_t at = page.find(mark);
  if (at == std::string::npos) {
    throw BakeError(ExitCode::internal,
                    "the built page of reports has no place for data; report it as a bug");
  }
  std::string text = data.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  for (std::size_t angle = text.find('<'); angle != std::string::npos; angle = text.find('<')) {
    text.replace(angle, 1, "\\u003c");
  }
  return page.substr(0, at) + text + page.substr(at + mark.size());
}

std::string built_page(ReportPage page) {
  namespace fs = std::filesystem;
  std::error_code problem;
  const fs::path program = fs::read_symlink("/proc/self/exe", problem);
  const fs::path path = program.parent_path().parent_path() / "share" / "spm-haptics" / "report" /
                        (page == ReportPage::asset ? "report.html" : "batch.html");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file || bytes.str().empty()) {
    throw BakeError(ExitCode::unsupported,
                    path.string() +
                        ": the page of reports is not there: it is built, with npm, by "
                        "scripts/build_page in the checkout");
  }
  return bytes.str();
}

}  // namespace spm::baker
