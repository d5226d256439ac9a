// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "formats/files/output_file.hpp"

namespace spm {

/// Writes an MCAP file (mcap.dev/spec, version 0) while its messages are made: chunks that are not
/// compressed, an index of the messages of each, checksums of chunks, data and summary. The same
/// calls give the same bytes. The file appears completely at `commit` or not at all.
class McapWriter {
 public:
  /// `profile` and `library` are those of the file's header. Errors: file_or_device, where the file
  /// cannot be created.
  [[nodiscard]] static Result<McapWriter> create(const std::string& path, std::string_view profile,
                                                 std::string_view library);

  /// Adds how messages are to be read, such as of the encoding `jsonschema`; its number. Before the
  /// first message.
  [[nodiscard]] std::uint16_t add_schema(std::string_view name, std::string_view encoding,
                                         std::string_view data);
  /// Adds a channel of messages in an encoding, such as `json`; its number. Before the first
  /// message.
  [[nodiscard]] std::uint16_t add_channel(std::uint16_t schema, std::string_view topic,
                                          std::string_view encoding);
  /// Adds what is told of the whole file.
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& values);

  /// Adds a message. `time_ns`: both when it was made and when it was logged.
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view payload);

  /// Writes the rest, syncs and renames. Errors: file_or_device, for any failure since `create`.
  [[nodiscard]] Result<void> commit();

 private:
  struct Channel {
    std::uint64_t messages = 0;
    std::string index;  ///< of the chunk that is being made
  };
  struct Times {
    std::uint64_t first = 0, last = 0;
    bool any = false;
    void take(std::uint64_t time) noexcept;
  };
  struct Group {
    std::uint8_t kind = 0;
    std::string records;
  };

  explicit McapWriter(OutputFile file) : file_(std::move(file)) {}
  void put(std::string_view bytes);
  void end_chunk();
  [[nodiscard]] std::string statistics() const;

  OutputFile file_;
  Result<void> state_;
  std::uint64_t written_ = 0;
  std::uint32_t crc_ = 0;  ///< of all that was written
  std::string chunk_;
  Times chunk_times_, times_;
  std::vector<Channel> channels_;  ///< by their number less 1
  std::string schemas_, channel_records_, chunk_indexes_, metadata_indexes_;
  std::uint16_t schema_count_ = 0;
  std::uint32_t chunk_count_ = 0, metadata_count_ = 0;
};

}  // namespace spm
