// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap/mcap_writer.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <type_traits>
#include <utility>

namespace spm {

namespace {

/// What a file begins and ends with.
constexpr std::string_view magic("\x89MCAP0\r\n", 8);
constexpr std::size_t chunk_bytes = std::size_t{1} << 20U;

enum Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel_record = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics_record = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// Makes the content of a record: little endian, texts with their length before them.
class Content {
 public:
  template <class Number>
  Content& add(Number number) {
    static_assert(std::is_unsigned_v<Number>);
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(number) >> (8 * i));
    }
    return *this;
  }
  /// A text, an array or a map.
  Content& add(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
    return *this;
  }
  Content& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(Opcode kind, const Content& content) {
  const auto size = static_cast<std::uint64_t>(content.bytes().size());
  return Content().add(std::uint8_t{kind}).add(size).raw(content.bytes()).bytes();
}

std::uint32_t crc_of(std::string_view bytes, std::uint32_t before = 0) noexcept {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace

void McapWriter::Times::take(std::uint64_t time) noexcept {
  first = any ? std::min(first, time) : time;
  last = any ? std::max(last, time) : time;
  any = true;
}

Result<McapWriter> McapWriter::create(const std::string& path, std::string_view profile,
                                      std::string_view library) {
  auto file = OutputFile::create(path);
  if (!file) return tl::make_unexpected(std::move(file.error()));
  McapWriter writer(std::move(*file));
  writer.put(magic);
  writer.put(record(header, Content().add(profile).add(library)));
  return writer;
}

void McapWriter::put(std::string_view bytes) {
  if (!state_) return;
  state_ = file_.write_at(written_, std::as_bytes(std::span(bytes)));
  written_ += bytes.size();
  crc_ = crc_of(bytes, crc_);
}

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding,
                                     std::string_view data) {
  const std::uint16_t number = ++schema_count_;
  const std::string bytes = record(schema, Content().add(number).add(name).add(encoding).add(data));
  schemas_ += bytes;
  put(bytes);
  return number;
}

std::uint16_t McapWriter::add_channel(std::uint16_t of_schema, std::string_view topic,
                                      std::string_view encoding) {
  channels_.emplace_back();
  const auto number = static_cast<std::uint16_t>(channels_.size());
  const std::string bytes =
      record(channel_record,
             Content().add(number).add(of_schema).add(topic).add(encoding).add(std::string_view()));
  channel_records_ += bytes;
  put(bytes);
  return number;
}

void McapWriter::add_metadata(std::string_view name,
                              const std::map<std::string, std::string>& values) {
  Content map;
  for (const auto& [key, value] : values)
    map.add(std::string_view(key)).add(std::string_view(value));
  const std::string bytes =
      record(metadata, Content().add(name).add(std::string_view(map.bytes())));
  metadata_indexes_ +=
      record(metadata_index, Content().add(written_).add(std::uint64_t{bytes.size()}).add(name));
  ++metadata_count_;
  put(bytes);
}

void McapWriter::write(std::uint16_t number, std::uint64_t time_ns, std::string_view payload) {
  Channel& channel = channels_[number - 1U];
  channel.index += Content().add(time_ns).add(std::uint64_t{chunk_.size()}).bytes();
  const auto sequence = static_cast<std::uint32_t>(channel.messages++);
  chunk_ +=
      record(message, Content().add(number).add(sequence).add(time_ns).add(time_ns).raw(payload));
  chunk_times_.take(time_ns);
  times_.take(time_ns);
  if (chunk_.size() >= chunk_bytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  const std::uint64_t start = written_;
  const std::uint64_t size = chunk_.size();
  put(record(chunk, Content()
                        .add(chunk_times_.first)
                        .add(chunk_times_.last)
                        .add(size)
                        .add(crc_of(chunk_))
                        .add(std::string_view())
                        .add(size)
                        .raw(chunk_)));
  const std::uint64_t length = written_ - start;
  Content offsets;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].index.empty()) continue;
    const auto number = static_cast<std::uint16_t>(i + 1);
    offsets.add(number).add(written_);
    put(record(message_index, Content().add(number).add(std::string_view(channels_[i].index))));
    channels_[i].index.clear();
  }
  chunk_indexes_ += record(chunk_index, Content()
                                            .add(chunk_times_.first)
                                            .add(chunk_times_.last)
                                            .add(start)
                                            .add(length)
                                            .add(std::string_view(offsets.bytes()))
                                            .add(written_ - start - length)
                                            .add(std::string_view())
                                            .add(size)
                                            .add(size));
  ++chunk_count_;
  chunk_.clear();
  chunk_times_ = {};
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0;
  Content counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    messages += channels_[i].messages;
    counts.add(static_cast<std::uint16_t>(i + 1)).add(channels_[i].messages);
  }
  constexpr std::uint32_t attachments = 0;
  return record(statistics_record, Content()
                                       .add(messages)
                                       .add(schema_count_)
                                       .add(static_cast<std::uint32_t>(channels_.size()))
                                       .add(attachments)
                                       .add(metadata_count_)
                                       .add(chunk_count_)
                                       .add(times_.first)
                                       .add(times_.last)
                                       .add(std::string_view(counts.bytes())));
}

Result<void> McapWriter::commit() {
  end_chunk();
  put(record(data_end, Content().add(crc_)));
  // The summary: what a reader needs to find its way, and where each kind of record begins in it.
  const std::uint64_t summary_start = written_;
  crc_ = 0;
  const std::array<Group, 5> groups{{{schema, schemas_},
                                     {channel_record, channel_records_},
                                     {statistics_record, statistics()},
                                     {metadata_index, metadata_indexes_},
                                     {chunk_index, chunk_indexes_}}};
  std::string offsets;
  for (const Group& group : groups) {
    if (group.records.empty()) continue;
    offsets +=
        record(summary_offset,
               Content().add(group.kind).add(written_).add(std::uint64_t{group.records.size()}));
    put(group.records);
  }
  const std::uint64_t offsets_start = written_;
  put(offsets);
  // The checksum of the summary covers the footer up to its place.
  constexpr std::uint64_t footer_bytes = 8 + 8 + 4;
  put(Content()
          .add(std::uint8_t{footer})
          .add(footer_bytes)
          .add(summary_start)
          .add(offsets_start)
          .bytes());
  const std::uint32_t crc = crc_;
  put(Content().add(crc).bytes());
  put(magic);
  if (!state_) return state_;
  return file_.commit();
}

}  // namespace spm
