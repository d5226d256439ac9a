// SPDX-License-Identifier: Apache-2.0
#include "formats/exr/exr_writer.hpp"

#include <openexr.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "formats/exr/exr_header.hpp"
#include "formats/files/checksum.hpp"

namespace spm {
namespace {

constexpr std::uint64_t largest_tile = std::numeric_limits<std::int32_t>::max();

/// Destination of the library's bytes: a file, or memory when only the header is needed.
struct Sink {
  OutputFile* file = nullptr;
  std::vector<std::byte> memory;
  std::optional<Error> error;
  std::string library_message;
};

std::int64_t write_to_sink(exr_const_context_t, void* user, const void* buffer, std::uint64_t size,
                           std::uint64_t offset, exr_stream_error_func_ptr_t) {
  auto& sink = *static_cast<Sink*>(user);
  const std::span bytes(static_cast<const std::byte*>(buffer), size);
  if (sink.file == nullptr) {
    if (sink.memory.size() < offset + size) sink.memory.resize(offset + size);
    std::copy(bytes.begin(), bytes.end(),
              sink.memory.begin() + static_cast<std::ptrdiff_t>(offset));
  } else if (auto written = sink.file->write_at(offset, bytes); !written) {
    if (!sink.error) sink.error = std::move(written.error());
    return -1;
  }
  return static_cast<std::int64_t>(size);
}

void keep_message(exr_const_context_t context, exr_result_t, const char* message) {
  void* user = nullptr;
  if (exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user != nullptr) {
    auto& sink = *static_cast<Sink*>(user);
    if (sink.library_message.empty()) sink.library_message = message;
  }
}

/// A write context of the library, closed at the end of its scope.
class Writer {
 public:
  explicit Writer(Sink& sink) : sink_(sink) {
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = &sink;
    settings.write_fn = write_to_sink;
    settings.error_handler_fn = keep_message;
    check(exr_start_write(&context_, "asset", EXR_WRITE_FILE_DIRECTLY, &settings));
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() {
    if (context_ != nullptr) exr_finish(&context_);
  }

  void check(exr_result_t result) { good_ = good_ && result == EXR_ERR_SUCCESS; }
  [[nodiscard]] bool good() const { return good_ && !sink_.error; }
  [[nodiscard]] exr_context_t context() const { return context_; }

  /// The chunk tables are written here.
  void finish() { check(exr_finish(&context_)); }

 private:
  Sink& sink_;
  exr_context_t context_ = nullptr;
  bool good_ = true;
};

exr_attr_box2i_t window_of(const PartPlan& part) {
  exr_attr_box2i_t window{};
  window.max.x = static_cast<std::int32_t>(part.tiles.columns * part.tile_width - 1);
  window.max.y = static_cast<std::int32_t>(part.tiles.rows * part.tile_height - 1);
  return window;
}

exr_pixel_type_t pixel_type(SampleType type) {
  switch (type) {
    case SampleType::half16:
      return EXR_PIXEL_HALF;
    case SampleType::float32:
      return EXR_PIXEL_FLOAT;
    case SampleType::uint32:
      break;
  }
  return EXR_PIXEL_UINT;
}

void define_part(Writer& writer, const PartPlan& part, const exr_attr_box2i_t& display) {
  exr_context_t context = writer.context();
  int index = 0;
  writer.check(exr_add_part(context, part.name.c_str(), EXR_STORAGE_TILED, &index));
  const exr_attr_box2i_t window = window_of(part);
  const exr_attr_v2f_t centre{};
  writer.check(exr_initialize_required_attr(context, index, &display, &window, 1.0F, &centre, 1.0F,
                                            EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_NONE));
  writer.check(exr_set_tile_descriptor(context, index, part.tile_width, part.tile_height,
                                       EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN));
  const exr_pixel_type_t type = pixel_type(part.type);
  for (const std::string& channel : part.channels) {
    writer.check(
        exr_add_channel(context, index, channel.c_str(), type, EXR_PERCEPTUALLY_LINEAR, 1, 1));
  }
}

void define_attribute(Writer& writer, const Attribute& attribute) {
  exr_context_t context = writer.context();
  const char* name = attribute.first.c_str();
  if (const auto* text = std::get_if<std::string>(&attribute.second)) {
    writer.check(exr_attr_set_string(context, 0, name, text->c_str()));
  } else if (const auto* integer = std::get_if<int>(&attribute.second)) {
    writer.check(exr_attr_set_int(context, 0, name, *integer));
  } else {
    writer.check(exr_attr_set_double(context, 0, name, std::get<double>(attribute.second)));
  }
}

void write_header(Writer& writer, const std::vector<PartPlan>& parts,
                  const std::vector<Attribute>& attributes) {
  for (const PartPlan& part : parts) define_part(writer, part, window_of(parts.front()));
  for (const Attribute& attribute : attributes) define_attribute(writer, attribute);
  if (writer.good()) writer.check(exr_write_header(writer.context()));
}

void write_tiles(Writer& writer, int index, const PartPlan& part) {
  std::vector<std::byte> scratch;
  for (std::uint32_t row = 0; row < part.tiles.rows; ++row) {
    for (std::uint32_t column = 0; column < part.tiles.columns && writer.good(); ++column) {
      const auto bytes = part.payload(row * part.tiles.columns + column, scratch);
      writer.check(exr_write_tile_chunk(writer.context(), index, static_cast<int>(column),
                                        static_cast<int>(row), 0, 0, bytes.data(), bytes.size()));
    }
  }
}

Error library_error(const std::string& path, const Sink& sink) {
  if (sink.error) return *sink.error;
  return {ExitCode::internal, path + ": the OpenEXR library refused to write it: " +
                                  sink.library_message + "; report this"};
}

std::vector<std::byte> header_bytes(const std::vector<PartPlan>& parts,
                                    const std::vector<Attribute>& attributes) {
  Sink sink;
  Writer writer(sink);
  write_header(writer, parts, attributes);
  return std::move(sink.memory);
}

/// Fills in size and checksum, both of fixed width, in a file that is otherwise complete.
Result<std::uint64_t> fill_in(OutputFile& file, const std::string& path,
                              std::span<const std::byte> header) {
  struct stat status {};
  const auto size_at = find_string_attribute(header, attribute_name::bytes);
  const auto digits_at = find_string_attribute(header, attribute_name::checksum);
  if (!size_at || !digits_at || ::fstat(file.descriptor(), &status) != 0) {
    return fail(ExitCode::internal, path + ": its header was not written whole; report this");
  }
  const auto size = static_cast<std::uint64_t>(status.st_size);
  std::string decimals = std::to_string(size);
  decimals.insert(0, bytes_decimals - decimals.size(), '0');
  if (auto done = file.write_at(size_at->offset, std::as_bytes(std::span(decimals))); !done) {
    return tl::make_unexpected(std::move(done.error()));
  }
  const auto checksum = file_checksum(file.descriptor(), size, digits_at->offset);
  if (!checksum) {
    return fail(ExitCode::file_or_device,
                path + ": cannot be read back for its checksum; check the disk");
  }
  const std::string digits = checksum_text(*checksum);
  if (auto done = file.write_at(digits_at->offset, std::as_bytes(std::span(digits))); !done) {
    return tl::make_unexpected(std::move(done.error()));
  }
  return size;
}

}  // namespace

Result<std::uint64_t> write_exr(OutputFile& file, const std::string& path,
                                const std::vector<PartPlan>& parts,
                                std::vector<Attribute> attributes) {
  for (const PartPlan& part : parts) {
    if (part.tile_bytes() > largest_tile) {
      return fail(ExitCode::invalid_input,
                  path + ": part " + part.name +
                      " exceeds the 2 GiB that one tile of an EXR can hold; bake with a coarser "
                      "tolerance or a smaller band");
    }
  }
  attributes.emplace_back(attribute_name::bytes, std::string(bytes_decimals, '0'));
  attributes.emplace_back(attribute_name::checksum, std::string(checksum_digits, '0'));
  attributes.emplace_back(attribute_name::pad, std::string(1, ' '));
  const std::uint64_t end = scan_header(header_bytes(parts, attributes)).end;
  attributes.back().second = std::string(1 + (8 - end % 8) % 8, ' ');
  const std::vector<std::byte> header = header_bytes(parts, attributes);

  Sink sink;
  sink.file = &file;
  {
    Writer writer(sink);
    write_header(writer, parts, attributes);
    for (std::size_t index = 0; index < parts.size() && writer.good(); ++index) {
      write_tiles(writer, static_cast<int>(index), parts[index]);
    }
    if (writer.good()) writer.finish();
    if (!writer.good()) return tl::make_unexpected(library_error(path, sink));
  }
  return fill_in(file, path, header);
}

}  // namespace spm
