// SPDX-License-Identifier: Apache-2.0
#include "servo/record/trace_csv.hpp"

#include <charconv>
#include <cstddef>
#include <span>
#include <utility>

namespace spm::servo {

namespace {

constexpr char header[] = "t,x,y,z,fx,fy,fz,tx,ty,tz,depth,contact\n";
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

}  // namespace

Result<TraceCsv> TraceCsv::create(const std::string& path) {
  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return tl::make_unexpected(std::move(file.error()));
  return TraceCsv(std::move(*file));
}

TraceCsv::TraceCsv(OutputFile file) : file_(std::move(file)), buffer_(header) {
  buffer_.reserve(2 * buffer_bytes);
}

void TraceCsv::append(const TraceRow& row) {
  char line[12 * longest_number];
  char* at = put(line, row.t);
  at = put(put(put(at, row.position), row.force), row.torque);
  at = put(at, row.depth);
  *at++ = row.contact ? '1' : '0';
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
