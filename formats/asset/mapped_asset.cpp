// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/mapped_asset.hpp"

#include <charconv>
#include <mutex>
#include <string_view>
#include <utility>

#include "formats/asset/asset_check.hpp"
#include "formats/asset/asset_json.hpp"
#include "formats/asset/asset_layout.hpp"
#include "formats/asset/file_mapping.hpp"
#include "formats/exr/exr_header.hpp"
#include "formats/exr/exr_index.hpp"
#include "formats/files/checksum.hpp"
#include "formats/files/host.hpp"
#include "formats/files/sha256.hpp"

namespace spm {

struct MappedAsset::Implementation {
  std::string path;
  std::unique_ptr<FileMapping> file;
  AssetDescription description;
  AssetTables tables;
  std::vector<PartInfo> parts;
  AssetBytes bytes;
  std::once_flag hashed;
  std::string sha256;
};

namespace {

tl::unexpected<Error> refuse(const std::string& path, const std::string& cause) {
  return fail(ExitCode::invalid_input, path + ": " + cause);
}

std::string_view text_at(std::span<const std::byte> bytes, const AttributePlace& place) {
  return {reinterpret_cast<const char*>(bytes.data()) + place.offset, place.size};
}

/// A file of the right kind is recognised by its first bytes and the attribute `spm`. One that lost
/// its end is recognised by the size that it records.
Result<void> check_identity(std::span<const std::byte> bytes, const std::string& path) {
  constexpr const char* cure = "; bake one with spm-bake build";
  if (!is_exr(bytes))
    return refuse(path, std::string("not an SPM asset: it is no EXR file") + cure);
  const ExrHeader header = scan_header(bytes);
  const auto size = find_string_attribute(bytes, attribute_name::bytes);
  std::uint64_t recorded = 0;
  if (size && size->size == bytes_decimals) {
    const std::string_view text = text_at(bytes, *size);
    std::from_chars(text.data(), text.data() + text.size(), recorded);
  }
  if (recorded > bytes.size()) {
    return refuse(path, "cut short: " + std::to_string(bytes.size()) + " of " +
                            std::to_string(recorded) +
                            " bytes are there; copy it again, or bake it again");
  }
  if (!header.complete)
    return refuse(path, "cut short in its header; copy it again, or bake it again");
  if (!find_string_attribute(bytes, attribute_name::description)) {
    return refuse(path, std::string("not an SPM asset: it has no `spm` attribute") + cure);
  }
  if (recorded != bytes.size()) {
    return refuse(
        path,
        "its size differs from the one it records: bytes were changed after the bake; bake "
        "it again");
  }
  return {};
}

Result<void> check_checksum(FileMapping& file, const std::string& path) {
  const std::span<const std::byte> bytes = file.bytes();
  const auto digits = find_string_attribute(bytes, attribute_name::checksum);
  if (!digits || digits->size != checksum_digits) {
    return refuse(path, "it records no checksum; bake it again");
  }
  const std::uint64_t checksum = file_checksum(bytes, digits->offset);
  if (text_at(bytes, *digits) != checksum_text(checksum)) {
    return refuse(path, "checksum differs: bytes were changed after the bake; bake it again");
  }
  file.set_checksum(digits->offset, checksum);
  return {};
}

PartInfo info_of(const ExrPart& part) {
  return {.name = part.name,
          .width = part.tiles.columns * part.tile_width,
          .height = part.tiles.rows * part.tile_height,
          .tile_width = part.tile_width,
          .tile_height = part.tile_height,
          .channels = part.channels,
          .payload_bytes = part.tile_bytes() * part.offsets.size()};
}

std::uint64_t payload_of(const std::vector<PartInfo>& parts, std::string_view prefix) {
  std::uint64_t bytes = 0;
  for (const PartInfo& part : parts) {
    if (part.name.starts_with(prefix)) bytes += part.payload_bytes;
  }
  return bytes;
}

}  // namespace

const char* to_string(AssetState state) noexcept {
  switch (state) {
    case AssetState::intact:
      return "intact";
    case AssetState::truncated:
      return "truncated";
    case AssetState::edited:
      return "edited";
    case AssetState::replaced:
      return "replaced";
    case AssetState::deleted:
      return "deleted";
  }
  return "unknown";
}

Result<std::unique_ptr<MappedAsset>> MappedAsset::open(const std::string& path,
                                                       const MapOptions& options) {
  const auto failed = [](auto& result) { return tl::make_unexpected(std::move(result.error())); };
  if (auto good = check_host(path); !good) return failed(good);
  Result<std::unique_ptr<FileMapping>> file = FileMapping::open(path, options);
  if (!file) return failed(file);
  const std::span<const std::byte> bytes = (*file)->bytes();
  if (auto good = check_identity(bytes, path); !good) return failed(good);
  if (auto good = check_checksum(**file, path); !good) return failed(good);
  const Result<std::vector<ExrPart>> parts = index_exr(bytes, path);
  if (!parts) return tl::make_unexpected(parts.error());
  const auto text = find_string_attribute(bytes, attribute_name::description);
  if (!text) return refuse(path, "not an SPM asset any more; bake it again");
  Result<AssetDescription> description = parse_description(text_at(bytes, *text), path);
  if (!description) return failed(description);
  Result<AssetTables> tables = lay_out(bytes, *parts, *description, path);
  if (!tables) return failed(tables);
  if (auto good = check_content(tables->view(), path); !good) return failed(good);
  if (options.prefault) (*file)->touch();
  // The file that is mapped now must be the one that was checked above.
  if (options.mode == MapMode::file && (*file)->state() != AssetState::intact) {
    return fail(ExitCode::file_or_device,
                path + ": changed while it was being opened; try again when it is complete");
  }

  auto implementation = std::make_unique<Implementation>();
  implementation->path = path;
  implementation->file = std::move(*file);
  implementation->description = std::move(*description);
  implementation->tables = std::move(*tables);
  for (const ExrPart& part : *parts) implementation->parts.push_back(info_of(part));
  implementation->bytes = {.total = bytes.size(),
                           .samples = payload_of(implementation->parts, part_name::heights),
                           .grid = payload_of(implementation->parts, "grid"),
                           .triangles = payload_of(implementation->parts, part_name::triangles)};
  return std::unique_ptr<MappedAsset>(new MappedAsset(std::move(implementation)));
}

MappedAsset::MappedAsset(std::unique_ptr<Implementation> implementation) noexcept
    : implementation_(std::move(implementation)) {}

MappedAsset::~MappedAsset() = default;

const AssetView& MappedAsset::view() const noexcept { return implementation_->tables.view(); }

const AssetMetadata& MappedAsset::metadata() const noexcept {
  return implementation_->description.metadata;
}

const std::string& MappedAsset::path() const noexcept { return implementation_->path; }

const std::vector<PartInfo>& MappedAsset::parts() const noexcept { return implementation_->parts; }

const std::string& MappedAsset::content_sha256() const noexcept {
  std::call_once(implementation_->hashed, [this] {
    implementation_->sha256 = sha256_bytes(implementation_->file->bytes());
  });
  return implementation_->sha256;
}

AssetBytes MappedAsset::bytes() const noexcept { return implementation_->bytes; }

std::uint64_t MappedAsset::resident_bytes() const noexcept {
  return implementation_->bytes.total + implementation_->tables.bytes();
}

bool MappedAsset::locked() const noexcept { return implementation_->file->locked(); }

bool MappedAsset::lost() const noexcept { return implementation_->file->lost(); }

AssetState MappedAsset::check_file() const noexcept { return implementation_->file->state(); }

}  // namespace spm
