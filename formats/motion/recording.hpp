// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "formats/files/output_file.hpp"

namespace spm {

/// One tick of the servo for one device, in the hand's frame; quaternions are unit, w first. Stored
/// in the file as it is in memory. scripts/charts/recording_file.py reads it too.
struct RecordingRow {
  std::uint64_t tick = 0;                     ///< index on the time grid
  std::array<double, 3> position{};           ///< m, of the hand
  std::array<double, 4> orientation{1};       ///< of the hand
  std::array<double, 3> wanted{};             ///< N, the result of the force law
  std::array<double, 3> wanted_torque{};      ///< N m, the same, about the hand's position
  std::array<double, 3> added{};              ///< N, what applications added to it
  std::array<double, 3> added_torque{};       ///< N m, the same
  std::array<double, 3> sent{};               ///< N, the force of both after the safety limits
  std::array<double, 3> sent_torque{};        ///< N m, the same
  std::array<double, 3> tool_position{};      ///< m, world: of the tool that the hand holds; or 0
  std::array<double, 4> tool_orientation{1};  ///< world
  double depth = 0;                           ///< m
  std::int32_t wake_ns = 0;                   ///< delay of the loop's wake-up
  std::int32_t busy_ns = 0;                   ///< from waking up to the last device's write
  std::uint32_t buttons = 0;
  /// Levels of the tool's samples that were coarser than the finest; 0 without a tool.
  std::uint32_t level = 0;
  /// Samples of the tool after which time was over to look on finer levels, and to move the tool
  /// on; the largest number where it was not.
  std::uint32_t refined = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t worked = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t culled = 0;  ///< objects that were found apart from the tool as a whole
  std::uint32_t reserved = 0;
  std::uint16_t device = 0;
  std::uint16_t flags = 0;    ///< bits of RecordingFlag
  std::uint16_t cause = 0;    ///< why the force was zero: an index into the header's causes
  std::uint16_t patches = 0;  ///< places at which the tool touches
  /// Where time did not suffice for all objects, and `held` or `shortened` is not 0: so many
  /// objects were computed exactly, from the number `first` on and round to the start. All 0
  /// otherwise.
  std::uint16_t first = 0, exact = 0;
  std::uint16_t held = 0;       ///< objects that were felt by their last plane
  std::uint16_t shortened = 0;  ///< objects whose proxy made fewer queries

  [[nodiscard]] bool operator==(const RecordingRow&) const = default;
};
static_assert(sizeof(RecordingRow) == 8 + 32 * 8 + 8 + 8 * 4 + 4 * 2 + 4 * 2);

/// Bits of RecordingRow::flags.
enum RecordingFlag : std::uint16_t {
  recorded_contact = 1,
  recorded_forgot = 2,   ///< the force law's state was reset before this tick
  recorded_lost = 4,     ///< ticks are missing before this one, because the recorder was too slow
  recorded_touched = 8,  ///< applications have moved, added or changed objects since the loop began
  recorded_edited = 16,  ///< an edited scene was applied before this tick's forces
  recorded_exchanged = 32,       ///< assets were opened, or opened again, before this tick
  recorded_force_capped = 64,    ///< the force met its cap
  recorded_torque_capped = 128,  ///< the torque met its cap
  recorded_tool_capped = 256,    ///< the coupling of hand and tool met its cap
  /// no force was sent, but the force law was asked and kept its state: a fade is over
  recorded_kept = 1024,
  recorded_tool = 512,  ///< the hand holds a tool whose pose is told
};

/// Format version of the files that are written; no other one is read. Versions 1 and 2 had rows
/// alone, without what their forces came from; version 3 had neither what applications added nor
/// which objects a tick had time for; version 4 had neither orientation nor torque nor a tool; what
/// changed in version 5 was felt as a step, and a hand without force lost its side.
inline constexpr std::uint32_t recording_form = 6;

struct RecordedDevice {
  std::string name;
  double encoder_step = 0;  ///< m
  /// N/m at the hand, upper limit of the stiffness of objects; infinity for none.
  double stiffness_cap = std::numeric_limits<double>::infinity();
  /// N, as it was for the run: the device's own or a smaller one; infinity for none.
  double force_cap = std::numeric_limits<double>::infinity();
  std::string profile;  ///< by which its settings were chosen; may be empty
  // Of its turning, as forces on a tool depend on it:
  bool turns = false;             ///< it tells its orientation
  double torque_cap = 0;          ///< N m, as it was for the run; infinity for none
  double turn_step = 0;           ///< rad, smallest turn that it resolves
  double turning_inertia = 1e-4;  ///< kg m2
};

struct RecordedAsset {
  std::string path;  ///< as it was opened; absolute
  std::string content_sha256;

  [[nodiscard]] bool operator==(const RecordedAsset&) const = default;
};

/// Header of a recording.
struct RecordingHeader {
  std::uint32_t form = recording_form;
  std::string spm_version;
  std::string instruction_set;  ///< with which the forces were computed
  double rate_hz = 1000;
  std::vector<RecordedDevice> devices;
  std::vector<std::string> causes;    ///< names of the causes of zero force, by number
  std::vector<RecordedAsset> assets;  ///< in the order in which the scene's objects number them
  std::string scene_path;             ///< empty if an asset was given
  std::string scene;  ///< what forces come from before the first row, JSON; may be empty
};

/// What changed in a scene, before the forces of a tick.
enum class RecordedKind : std::uint32_t {
  placed = 2,      ///< an object lies elsewhere
  added = 3,       ///< an object is new
  changed = 4,     ///< an object has other settings
  removed = 5,     ///< an object is gone
  stabilized = 6,  ///< the scene has other stabilization settings
  assets = 7,      ///< the list of assets is another one
  lost = 8,        ///< changes are missing, because the recorder was too slow
};

/// One change.
struct RecordedChange {
  std::uint64_t tick = 0;  ///< it came before the forces of this tick
  RecordedKind kind = RecordedKind::placed;
  std::uint32_t object = 0;
  std::array<double, 7> pose{};       ///< of `placed`: position in m, unit quaternion w first
  std::string settings;               ///< JSON: of `added`, `changed` and `stabilized`
  std::vector<RecordedAsset> assets;  ///< of `assets`
};

struct Recording {
  RecordingHeader header;
  std::vector<RecordingRow> rows;       ///< ordered by tick, then by device
  std::vector<RecordedChange> changes;  ///< ordered by tick, then as they came
};

/// The parts of a recording's file as bytes: one start, then any number of rows and changes in the
/// order in which they came, then the end. The start is the magic number `SPM-REC1`; a word with
/// the number of bytes of the header, and a word 0; the header, JSON, padded with blanks to eight
/// bytes. Each part after it begins with two words, its kind (1: a row) and the number of its
/// bytes, a multiple of eight. The end is the number of these parts and the XXH3-64 of everything
/// before it, eight bytes each. Little endian.
[[nodiscard]] std::string recording_start(const RecordingHeader& header);
void append_part(std::string& bytes, const RecordingRow& row);
void append_part(std::string& bytes, const RecordedChange& change);

/// Writes a recording whose start and parts were made already. The file appears completely or not
/// at all. Errors: file_or_device.
[[nodiscard]] Result<void> write_recording(const std::string& path, std::string_view start,
                                           std::span<const std::string_view> parts);

/// Writes a recording while it is made. The file appears completely at `commit` or not at all.
class RecordingWriter {
 public:
  /// Errors: file_or_device, where the file cannot be created.
  [[nodiscard]] static Result<RecordingWriter> create(const std::string& path,
                                                      const RecordingHeader& header) {
    return create_with(path, recording_start(header));
  }
  /// The same with a start that was made already.
  [[nodiscard]] static Result<RecordingWriter> create_with(const std::string& path,
                                                           std::string_view start);

  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;
  ~RecordingWriter();

  /// Buffers a row; `commit` reports an error while writing (a full disk).
  void append(const RecordingRow& row);
  void append(const RecordedChange& change);
  /// Any number of parts in the form of append_part. What follows a part that is cut short is left
  /// out.
  void append(std::string_view parts);

  /// Whether all parts so far could be written.
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
  std::uint64_t parts_ = 0;
  Result<void> state_;
};

/// Whether a file begins as a recording does; false also where the file cannot be read.
[[nodiscard]] bool is_recording(const std::string& path);

/// Reads a whole recording. Errors: file_or_device; invalid_input where it is not a recording, was
/// cut short or changed, or has an older or newer version.
[[nodiscard]] Result<Recording> read_recording(const std::string& path);

}  // namespace spm
