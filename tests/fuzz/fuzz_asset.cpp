// SPDX-License-Identifier: Apache-2.0
// Baked files with right sums and any content: opening, queries, the proxy, a tool's samples, and
// the picture's mesh.
#include <charconv>
#include <cmath>
#include <cstring>
#include <span>

#include "common/contact/proxy.hpp"
#include "common/contour/contour_mesh.hpp"
#include "common/query/query.hpp"
#include "common/sixdof/surface_samples.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "formats/exr/exr_header.hpp"
#include "formats/exr/exr_layout.hpp"
#include "formats/files/checksum.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/servo/support/shape_asset.hpp"
#include "tests/support/shapes.hpp"

namespace spm::fuzz {

namespace {

/// Size and checksum as they must be, so that changed files come past the first checks.
void put_right(std::string& bytes) {
  const auto content = std::as_writable_bytes(std::span(bytes));
  const auto size = find_string_attribute(content, attribute_name::bytes);
  if (size && size->size == bytes_decimals) {
    std::string digits = std::to_string(bytes.size());
    digits.insert(0, bytes_decimals - digits.size(), '0');
    std::memcpy(bytes.data() + size->offset, digits.data(), digits.size());
  }
  const auto sum = find_string_attribute(content, attribute_name::checksum);
  if (!sum || sum->size != checksum_digits) return;
  const std::string text = checksum_text(file_checksum(content, sum->offset));
  std::memcpy(bytes.data() + sum->offset, text.data(), text.size());
}

/// Places in and about an asset's box.
Vector3 place(const Extent& extent, int i) {
  const Vector3 share(0.137 * (i % 11) - 0.2, 0.113 * (i % 13) - 0.2, 0.093 * (i % 17) - 0.2);
  return extent.low + share.cwiseProduct(extent.size);
}

void ask(const AssetView& asset) {
  const Extent extent = extent_of(asset);
  ProxyState state;
  for (int i = 0; i < 60; ++i) {
    const Vector3 at = place(extent, i);
    const Answer answer = query_point(asset, at);
    if (answer.status == Status::exact) {
      require(std::isfinite(answer.distance) && answer.normal.allFinite(), "an answer is a number");
    }
    require(!std::isnan(clearance(asset, at)), "a clearance is a number");
    const ProxyContact contact = move_proxy(asset, 0, at, state);
    require(std::isfinite(contact.depth) && contact.proxy.allFinite(), "a proxy is somewhere");
  }
  if (!asset.full) static_cast<void>(sample_surface(asset, extent.size.maxCoeff() / 40));
  static_cast<void>(contour_mesh(asset, 12));
}

std::string baked(const Asset& asset) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("seed.spm.exr");
  test::write(asset, path);
  return bytes_of(path);
}

}  // namespace

std::vector<std::string> seeds() {
  return {baked(test::shape_asset(test::box({0.01, 0.012, 0.008}))), baked(test::box_asset(0.01))};
}

std::vector<std::string> endings() { return {".spm.exr"}; }

}  // namespace spm::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static spm::fuzz::ScratchFile file;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  spm::fuzz::put_right(bytes);
  file.write(bytes);
  spm::MapOptions options;
  options.mode = spm::MapMode::sealed;
  const auto asset = spm::MappedAsset::open(file.path(), options);
  if (asset) spm::fuzz::ask((*asset)->view());
  return 0;
}
