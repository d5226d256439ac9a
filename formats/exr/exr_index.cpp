// SPDX-License-Identifier: Apache-2.0
#include "formats/exr/exr_index.hpp"

#include <openexr.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <set>
#include <utility>

#include "formats/exr/exr_header.hpp"

namespace spm {
namespace {

constexpr int largest_image_side = 1 << 26;
constexpr int largest_tile_side = 1 << 24;
constexpr std::size_t largest_allocation = std::size_t{1} << 30U;
constexpr int max_parts = 300;  // 255 numbers of layers and the grid

struct Source {
  std::span<const std::byte> bytes;
  std::string message;
};

std::int64_t read_source(exr_const_context_t, void* user, void* buffer, std::uint64_t size,
                         std::uint64_t offset, exr_stream_error_func_ptr_t) {
  const std::span<const std::byte> bytes = static_cast<const Source*>(user)->bytes;
  if (offset > bytes.size()) return -1;
  const std::uint64_t count = std::min<std::uint64_t>(size, bytes.size() - offset);
  std::memcpy(buffer, bytes.data() + offset, count);
  return static_cast<std::int64_t>(count);
}

std::int64_t source_size(exr_const_context_t, void* user) {
  return static_cast<std::int64_t>(static_cast<const Source*>(user)->bytes.size());
}

void keep_message(exr_const_context_t context, exr_result_t, const char* message) {
  void* user = nullptr;
  if (exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user != nullptr) {
    std::string& kept = static_cast<Source*>(user)->message;
    if (kept.empty()) kept = message;
  }
}

void* bounded_allocation(std::size_t size) {
  return size > largest_allocation ? nullptr : std::malloc(size);
}

/// A read context of the library, closed at the end of its scope.
class Reader {
 public:
  explicit Reader(Source& source) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = &source;
    settings.read_fn = read_source;
    settings.size_fn = source_size;
    settings.error_handler_fn = keep_message;
    settings.alloc_fn = bounded_allocation;
    settings.free_fn = std::free;
    settings.max_image_width = largest_image_side;
    settings.max_image_height = largest_image_side;
    settings.max_tile_width = largest_tile_side;
    settings.max_tile_height = largest_tile_side;
    settings.flags = EXR_CONTEXT_FLAG_STRICT_HEADER | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    good_ = exr_start_read(&context_, "asset", &settings) == EXR_ERR_SUCCESS;
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() {
    if (context_ != nullptr) exr_finish(&context_);
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] exr_const_context_t context() const { return context_; }

 private:
  exr_context_t context_ = nullptr;
  bool good_ = false;
};

/// Each step below returns the error, or an empty text.
using Cause = std::string;

Cause read_storage(exr_const_context_t context, int index, ExrPart& part) {
  const char* name = nullptr;
  if (exr_get_name(context, index, &name) != EXR_ERR_SUCCESS || name == nullptr) {
    return "one of its parts has no name";
  }
  part.name = name;
  exr_storage_t storage{};
  if (exr_get_storage(context, index, &storage) != EXR_ERR_SUCCESS ||
      storage != EXR_STORAGE_TILED) {
    return "part " + part.name + " is not tiled";
  }
  exr_compression_t compression{};
  if (exr_get_compression(context, index, &compression) != EXR_ERR_SUCCESS ||
      compression != EXR_COMPRESSION_NONE) {
    return "part " + part.name + " is compressed";
  }
  exr_lineorder_t order{};
  if (exr_get_lineorder(context, index, &order) != EXR_ERR_SUCCESS ||
      order != EXR_LINEORDER_INCREASING_Y) {
    return "part " + part.name + " is not in increasing line order";
  }
  return {};
}

Cause read_channels(exr_const_context_t context, int index, ExrPart& part) {
  const exr_attr_chlist_t* list = nullptr;
  if (exr_get_channels(context, index, &list) != EXR_ERR_SUCCESS || list->num_channels < 1) {
    return "part " + part.name + " has no channel";
  }
  const exr_pixel_type_t type = list->entries[0].pixel_type;
  for (int k = 0; k < list->num_channels; ++k) {
    const exr_attr_chlist_entry_t& channel = list->entries[k];
    if (channel.pixel_type != type || channel.x_sampling != 1 || channel.y_sampling != 1) {
      return "the channels of part " + part.name + " are not of one type and size";
    }
    part.channels.emplace_back(channel.name.str);
  }
  part.type = type == EXR_PIXEL_HALF    ? SampleType::half16
              : type == EXR_PIXEL_FLOAT ? SampleType::float32
                                        : SampleType::uint32;
  return {};
}

Cause read_windows(exr_const_context_t context, int index, ExrPart& part) {
  exr_attr_box2i_t window{};
  exr_tile_level_mode_t level{};
  exr_tile_round_mode_t round{};
  if (exr_get_data_window(context, index, &window) != EXR_ERR_SUCCESS || window.min.x != 0 ||
      window.min.y != 0 || window.max.x < 0 || window.max.y < 0 ||
      exr_get_tile_descriptor(context, index, &part.tile_width, &part.tile_height, &level,
                              &round) != EXR_ERR_SUCCESS ||
      level != EXR_TILE_ONE_LEVEL || part.tile_width == 0 || part.tile_height == 0) {
    return "part " + part.name + " has an unexpected window or tiling";
  }
  const std::uint32_t width = static_cast<std::uint32_t>(window.max.x) + 1;
  const std::uint32_t height = static_cast<std::uint32_t>(window.max.y) + 1;
  part.tiles = {width / part.tile_width, height / part.tile_height};
  std::int32_t chunks = 0;
  if (width % part.tile_width != 0 || height % part.tile_height != 0 ||
      exr_get_chunk_count(context, index, &chunks) != EXR_ERR_SUCCESS || chunks < 0 ||
      std::uint64_t{part.tiles.columns} * part.tiles.rows != static_cast<std::uint64_t>(chunks)) {
    return "the tiles of part " + part.name + " do not fill its window";
  }
  return {};
}

Cause read_tiles(exr_const_context_t context, int index, std::uint64_t file_size, ExrPart& part) {
  const std::uint64_t bytes = part.tile_bytes();
  for (std::uint32_t row = 0; row < part.tiles.rows; ++row) {
    for (std::uint32_t column = 0; column < part.tiles.columns; ++column) {
      exr_chunk_info_t chunk{};
      const bool read =
          exr_read_tile_chunk_info(context, index, static_cast<int>(column), static_cast<int>(row),
                                   0, 0, &chunk) == EXR_ERR_SUCCESS;
      if (!read || chunk.width != static_cast<std::int32_t>(part.tile_width) ||
          chunk.height != static_cast<std::int32_t>(part.tile_height) ||
          chunk.packed_size != bytes || chunk.unpacked_size != bytes || bytes > file_size ||
          chunk.data_offset > file_size - bytes ||
          chunk.data_offset % sample_bytes(part.type) != 0) {
        return "tile " + std::to_string(column) + ", " + std::to_string(row) + " of part " +
               part.name + " is damaged";
      }
      part.offsets.push_back(chunk.data_offset);
    }
  }
  return {};
}

/// Tiles must follow the tables, and each other, without overlap and without a gap.
Cause check_coverage(const std::vector<ExrPart>& parts, std::uint64_t header_end,
                     std::uint64_t file_size) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> chunks;  // begin, end
  for (const ExrPart& part : parts) {
    for (const std::uint64_t offset : part.offsets) {
      if (offset < chunk_header_bytes) return "a tile lies in its header";
      chunks.emplace_back(offset - chunk_header_bytes, offset + part.tile_bytes());
    }
  }
  std::sort(chunks.begin(), chunks.end());
  std::uint64_t end = header_end + 8 * chunks.size();
  for (const auto& [chunk_begin, chunk_end] : chunks) {
    if (chunk_begin != end) return "its tiles overlap or leave gaps";
    end = chunk_end;
  }
  return end == file_size ? Cause() : "it does not end with its last tile";
}

Cause read_part(exr_const_context_t context, int index, std::uint64_t file_size, ExrPart& part) {
  Cause cause = read_storage(context, index, part);
  if (cause.empty()) cause = read_channels(context, index, part);
  if (cause.empty()) cause = read_windows(context, index, part);
  if (cause.empty()) cause = read_tiles(context, index, file_size, part);
  return cause;
}

Cause read_parts(exr_const_context_t context, std::span<const std::byte> bytes,
                 std::vector<ExrPart>& parts) {
  int count = 0;
  if (exr_get_count(context, &count) != EXR_ERR_SUCCESS || count < 1 || count > max_parts) {
    return "it has no parts, or too many";
  }
  std::set<std::string> names;
  for (int index = 0; index < count; ++index) {
    ExrPart part;
    if (Cause cause = read_part(context, index, bytes.size(), part); !cause.empty()) return cause;
    if (!names.insert(part.name).second) return "two of its parts are named " + part.name;
    parts.push_back(std::move(part));
  }
  return check_coverage(parts, scan_header(bytes).end, bytes.size());
}

}  // namespace

Result<std::vector<ExrPart>> index_exr(std::span<const std::byte> bytes, const std::string& path) {
  Source source{bytes, {}};
  const Reader reader(source);
  Cause cause;
  std::vector<ExrPart> parts;
  if (!scan_header(bytes).multi_part) {
    cause = "it is not a multi-part EXR";
  } else if (!reader.good()) {
    cause = "its EXR header is damaged" + (source.message.empty() ? "" : ": " + source.message);
  } else {
    cause = read_parts(reader.context(), bytes, parts);
  }
  if (!cause.empty()) {
    return fail(ExitCode::invalid_input, path + ": " + cause + "; bake it again");
  }
  return parts;
}

}  // namespace spm
