// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "common/base/error.hpp"
#include "common/base/vector.hpp"
#include "formats/files/output_file.hpp"

namespace spm::servo {

/// One tick as a row of a table: seconds, metres, newtons.
struct TraceRow {
  double t = 0;
  Vector3 position = Vector3::Zero();
  Vector3 force = Vector3::Zero();
  Vector3 torque = Vector3::Zero();
  double depth = 0;
  bool contact = false;
};

/// Writes rows as CSV (`t,x,y,z,fx,fy,fz,tx,ty,tz,depth,contact`). Numbers are read back exactly,
/// in any locale. The file appears complete at `commit` or not at all.
class TraceCsv {
 public:
  /// Errors: file_or_device, if the file cannot be created.
  [[nodiscard]] static Result<TraceCsv> create(const std::string& path);

  /// Buffers a row. An error while writing is reported by `commit`.
  void append(const TraceRow& row);

  /// Writes the rest, syncs and renames. Errors: file_or_device, for any failure since `create`.
  [[nodiscard]] Result<void> commit();

 private:
  explicit TraceCsv(OutputFile file);
  void flush();

  OutputFile file_;
  std::string buffer_;
  std::uint64_t written_ = 0;
  Result<void> state_;
};

}  // namespace spm::servo
