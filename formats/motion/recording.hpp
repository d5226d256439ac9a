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

/// What one tick of the servo did to one device. Lies in the file as it is in memory.
struct RecordingRow {
  std::uint64_t tick = 0;            ///< index on the time grid
  std::array<double, 3> position{};  ///< m
  std::array<double, 3> wanted{};    ///< N, what the force law said
  std::array<double, 3> sent{};      ///< N, what safety left of it
  double depth = 0;                  ///< m
  std::int32_t wake_ns = 0;          ///< how late the loop woke up
  std::int32_t busy_ns = 0;          ///< from waking up to the last device's write
  std::uint32_t buttons = 0;
  std::uint16_t device = 0;
  std::uint8_t cause = 0;  ///< why the force was zero: a number of the header's causes
  std::uint8_t flags = 0;  ///< of RecordingFlag
};
static_assert(sizeof(RecordingRow) == 8 + 9 * 8 + 8 + 2 * 4 + 4 + 2 + 2);

/// Bits of RecordingRow::flags.
enum RecordingFlag : std::uint8_t {
  recorded_contact = 1,
  recorded_forgot = 2,   ///< the force law had forgotten what was before this tick
  recorded_lost = 4,     ///< ticks before this one are missing: the recorder was too slow
  recorded_touched = 8,  ///< applications have moved, added or changed objects since the loop began
  recorded_edited = 16,  ///< an edited scene was taken up before this tick's forces
};

/// The form of files that are written. Form 1, which its header does not name, has no marks of
/// changed scenes (`recorded_touched`, `recorded_edited`), and is read too.
inline constexpr std::uint32_t recording_form = 2;

struct RecordedDevice {
  std::string name;
  double encoder_step = 0;  ///< m
  /// N a metre of the hand, that no object was felt above; infinity for none.
  double stiffness_cap = std::numeric_limits<double>::infinity();
};

/// What a recording says of itself.
struct RecordingHeader {
  std::uint32_t form = recording_form;
  std::string spm_version;
  std::string instruction_set;  ///< that the forces were computed with
  double rate_hz = 1000;
  std::vector<RecordedDevice> devices;
  std::vector<std::string> causes;  ///< names of the causes of zero force, by number
  std::vector<std::string> assets;  ///< content_sha256 of those that were served
};

struct Recording {
  RecordingHeader header;
  std::vector<RecordingRow> rows;  ///< in the order of ticks, and in a tick of devices
};

/// Writes a recording as it comes: the magic number `SPM-REC1`; a word that counts the bytes of the
/// header and a word 0; the header, JSON, with blanks up to eight bytes; the rows; and at the end
/// the count of the rows and the XXH3-64 of all before it, eight bytes each. Little endian. The
/// file appears whole at `commit` or not at all.
class RecordingWriter {
 public:
  /// Errors: file_or_device, where the file cannot be created.
  [[nodiscard]] static Result<RecordingWriter> create(const std::string& path,
                                                      const RecordingHeader& header);

  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;
  ~RecordingWriter();

  /// Buffers a row; an error while writing (a full disk) is told by `commit`.
  void append(const RecordingRow& row);

  /// Whether all rows could be written so far.
  [[nodiscard]] bool ok() const noexcept { return state_.has_value(); }

  /// Writes the rest, syncs and renames. Errors: file_or_device, of anything since `create`.
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

/// Whether a file begins as a recording does; false also where it cannot be read.
[[nodiscard]] bool is_recording(const std::string& path);

/// Reads a recording whole. Errors: file_or_device; invalid_input where it is no recording, was cut
/// short or changed, or is of a newer form.
[[nodiscard]] Result<Recording> read_recording(const std::string& path);

}  // namespace spm
