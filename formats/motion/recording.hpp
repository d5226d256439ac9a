// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "formats/files/output_file.hpp"

namespace spm {

/// One tick of the servo for one device. Stored in the file as it is in memory.
struct RecordingRow {
  std::uint64_t tick = 0;            ///< index on the time grid
  std::array<double, 3> position{};  ///< m
  std::array<double, 3> wanted{};    ///< N, the result of the force law
  std::array<double, 3> sent{};      ///< N, the force after the safety limits
  double depth = 0;                  ///< m
  std::int32_t wake_ns = 0;          ///< delay of the loop's wake-up
  std::int32_t busy_ns = 0;          ///< from waking up to the last device's write
  std::uint32_t buttons = 0;
  std::uint16_t device = 0;
  std::uint8_t cause = 0;  ///< why the force was zero: an index into the header's causes
  std::uint8_t flags = 0;  ///< bits of RecordingFlag
};
static_assert(sizeof(RecordingRow) == 8 + 9 * 8 + 8 + 2 * 4 + 4 + 2 + 2);

/// Bits of RecordingRow::flags.
enum RecordingFlag : std::uint8_t {
  recorded_contact = 1,
  recorded_forgot = 2,   ///< the force law's state was reset before this tick
  recorded_lost = 4,     ///< ticks are missing before this one, because the recorder was too slow
  recorded_touched = 8,  ///< applications have moved, added or changed objects since the loop began
  recorded_edited = 16,  ///< an edited scene was applied before this tick's forces
};

/// Format version of the files that are written. Version 1, which its header does not name, has no
/// flags for changed scenes (`recorded_touched`, `recorded_edited`); it can still be read.
inline constexpr std::uint32_t recording_form = 2;

struct RecordedDevice {
  std::string name;
  double encoder_step = 0;  ///< m
  /// N/m at the hand, upper limit of the stiffness of objects; infinity for none.
  double stiffness_cap = std::numeric_limits<double>::infinity();
};

/// Header of a recording.
struct RecordingHeader {
  std::uint32_t form = recording_form;
  std::string spm_version;
  std::string instruction_set;  ///< with which the forces were computed
  double rate_hz = 1000;
  std::vector<RecordedDevice> devices;
  std::vector<std::string> causes;  ///< names of the causes of zero force, by number
  std::vector<std::string> assets;  ///< content_sha256 of the assets that were loaded
};

struct Recording {
  RecordingHeader header;
  std::vector<RecordingRow> rows;  ///< ordered by tick, then by device
};

/// Writes a recording while it is made: the magic number `SPM-REC1`; a word with the number of
/// bytes of the header, and a word 0; the header, JSON, padded with blanks to eight bytes; the
/// rows; and at the end the number of rows and the XXH3-64 of everything before it, eight bytes
/// each. Little endian. The file appears completely at `commit` or not at all.
class RecordingWriter {
 public:
  /// Errors: file_or_device, where the file cannot be created.
  [[nodiscard]] static Result<RecordingWriter> create(const std::string& path,
                                                      const RecordingHeader& header);

  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;
  ~RecordingWriter();

  /// Buffers a row; `commit` reports an error while writing (a full disk).
  void append(const RecordingRow& row);

  /// Whether all rows so far could be written.
  [[nodiscard]] bool ok() const noexcept { return state_.has_value(); }

  /// Writes the rest, syncs and renames. Errors: file_or_device, for any failure since `create`.
  [[nodiscard]] Result<void> commit();

 private:
  struct Hash;

  explicit RecordingWriter(OutputFile file);
  void flush();

  OutputFile file_;
  std::unique_ptr<Hash> hash_;
  std::string buffer_;
  std::uint64_t written_ = 0;
  std::uint64_t rows_ = 0;
  Result<void> state_;
};

/// Whether a file begins as a recording does; false also where the file cannot be read.
[[nodiscard]] bool is_recording(const std::string& path);

/// Reads a whole recording. Errors: file_or_device; invalid_input where it is not a recording, was
/// cut short or changed, or has a newer version.
[[nodiscard]] Result<Recording> read_recording(const std::string& path);

}  // namespace spm
