// SPDX-License-Identifier: Apache-2.0
#include "servo/record/trace_csv.hpp"

#include <charconv>
#include <cstddef>
#include <span>
#include <utility>

namespace spm::servo {

namespace {

constexpr char header[] = "t,x,y,z,fx,fy,fz,tx,ty,tz,depth,contact";
constexpr char tool_header[] =
    ",qw,qx,qy,qz,tool_x,tool_y,tool_z,tool_qw,tool_qx,tool_qy,tool_qz,patches,level,culled,"
    "force_capped,torque_capped,tool_capped";
constexpr std::size_t most_columns = 29;
constexpr std::size_t longest_number = 32;
constexpr std::size_t buffer_bytes = 1 << 16;

char* put(char* at, double number) {
  // A negative zero looks odd in a file and has no meaning here.
  at = std::to_chars(at, at + longest_number, number == 0 ? 0.0 : number).ptr;
  *at++ = ',';
  return at;
}

char* put(char* at, const Vector3& vector) {
  return put(put(put(at, vector.x()), vector.y()), vector.z());
}

char* put(char* at, const Eigen::Quaterniond& turn) {
  return put(put(at, turn.w()), Vector3(turn.vec()));
}

}  // namespace

Result<TraceCsv> TraceCsv::create(const std::string& path, bool with_tool) {
  Result<OutputFile> file = OutputFile::create(path, WhileOpen::named);
  if (!file) return tl::make_unexpected(std::move(file.error()));
  return TraceCsv(std::move(*file), with_tool);
}

TraceCsv::TraceCsv(OutputFile file, bool with_tool)
    : file_(std::move(file)), with_tool_(with_tool), buffer_(header) {
  buffer_ += with_tool ? tool_header : "";
  buffer_ += '\n';
  buffer_.reserve(2 * buffer_bytes);
}

void TraceCsv::append(const TraceRow& row) {
  char line[most_columns * longest_number];
  char* at = put(line, row.t);
  at = put(put(put(at, row.position), row.force), row.torque);
  at = put(at, row.depth);
  *at++ = row.contact ? '1' : '0';
  if (with_tool_) {
    *at++ = ',';
    at = put(put(put(at, row.orientation), row.tool.position), row.tool.orientation);
    at = put(put(put(at, row.patches), row.level), row.culled);
    at = put(put(at, row.force_capped ? 1 : 0), row.torque_capped ? 1 : 0);
    *at++ = row.tool_capped ? '1' : '0';
  }
  *at++ = '\n';
  buffer_.append(line, at);
  if (buffer_.size() >= buffer_bytes) flush();
}

void TraceCsv::flush() {
  if (state_) state_ = file_.write_at(written_, std::as_bytes(std::span(buffer_)));
  written_ += buffer_.size();
  buffer_.clear();
}

Result<void> TraceCsv::commit() {
  flush();
  if (!state_) return state_;
  return file_.commit();
}

}  // namespace spm::servo
