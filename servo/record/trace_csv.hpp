// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/base/error.hpp"
#include "common/base/hand_pose.hpp"
#include "common/base/vector.hpp"
#include "formats/files/output_file.hpp"

namespace spm::servo {

/// One tick as a row of a table: seconds, metres, newtons, newton metres.
struct TraceRow {
  double t = 0;
  Vector3 position = Vector3::Zero();
  Vector3 force = Vector3::Zero();
  Vector3 torque = Vector3::Zero();
  double depth = 0;
  bool contact = false;
  // Written with a tool alone:
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< of the hand
  HandPose tool;                                                    ///< world
  std::uint32_t patches = 0;                                        ///< places at which it touches
  std::uint32_t level = 0;   ///< of its samples, coarser than the finest
  std::uint32_t culled = 0;  ///< objects that were found apart from it as a whole
  bool force_capped = false, torque_capped = false, tool_capped = false;
};

/// Writes rows as CSV (`t,x,y,z,fx,fy,fz,tx,ty,tz,depth,contact`), and with a tool further columns
/// after these. Numbers are read back exactly, in any locale. The file appears complete at `commit`
/// or not at all.
class TraceCsv {
 public:
  /// Errors: file_or_device, if the file cannot be created.
  [[nodiscard]] static Result<TraceCsv> create(const std::string& path, bool with_tool = false);

  /// Buffers a row. An error while writing is reported by `commit`.
  void append(const TraceRow& row);

  /// Writes the rest, syncs and renames. Errors: file_or_device, for any failure since `create`.
  [[nodiscard]] Result<void> commit();

 private:
  TraceCsv(OutputFile file, bool with_tool);
  void flush();

  OutputFile file_;
  bool with_tool_;
  std::string buffer_;
  std::uint64_t written_ = 0;
  Result<void> state_;
};

}  // namespace spm::servo
