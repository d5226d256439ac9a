// SPDX-License-Identifier: Apache-2.0
#include "common/paper/probe_shape.hpp"

#include <array>

#include "common/base/units.hpp"

namespace spm {

namespace {

/// How a kind of probe is written: a word, and the sizes that follow its colon. In the order of
/// ProbeKind.
struct KindText {
  std::string_view word, sizes, example;
  bool has_length;
};
constexpr std::array kinds{KindText{"sphere", "RADIUS", "sphere:0.5mm", false},
                           KindText{"capsule", "RADIUS,LENGTH", "capsule:0.5mm,10mm", true}};

tl::unexpected<Error> wrong(std::string_view text, const std::string& what) {
  return fail(ExitCode::usage, std::string(1, '\'').append(text).append("' ").append(what));
}

/// How a kind is written, and an example.
std::string written(const KindText& kind) {
  return std::string(kind.word)
      .append(":")
      .append(kind.sizes)
      .append(" such as ")
      .append(kind.example);
}

Result<void> read_size(std::string_view text, std::string_view part, double& size) {
  const Result<double> value = parse_quantity(part, Quantity::length);
  if (!value) return wrong(text, "is not a probe: " + value.error().message);
  // Written so that NaN has no size.
  if (!(*value > 0)) return wrong(text, "has a size that is not above 0: write lengths above 0");
  size = *value;
  return {};
}

}  // namespace

Result<ProbeShape> parse_probe_shape(std::string_view text) {
  ProbeShape shape;
  if (text == "point") return shape;
  const std::size_t colon = text.find(':');
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const KindText& kind = kinds[i];
    if (colon == text.npos || text.substr(0, colon) != kind.word) continue;
    const std::string_view sizes = text.substr(colon + 1);
    const std::size_t comma = sizes.find(',');
    if ((comma != sizes.npos) != kind.has_length) {
      return wrong(text, std::string("has not the sizes of a ")
                             .append(kind.word)
                             .append(": write ")
                             .append(written(kind)));
    }
    shape.kind = static_cast<ProbeKind>(i);
    if (auto read = read_size(text, sizes.substr(0, comma), shape.radius); !read) {
      return tl::make_unexpected(std::move(read.error()));
    }
    if (kind.has_length) {
      if (auto read = read_size(text, sizes.substr(comma + 1), shape.length); !read) {
        return tl::make_unexpected(std::move(read.error()));
      }
    }
    return shape;
  }
  std::string cure = "is not a probe: write point";
  for (const KindText& kind : kinds) {
    cure.append(&kind == &kinds.back() ? " or " : ", ").append(written(kind));
  }
  return wrong(text, cure);
}

std::string text_of(const ProbeShape& shape) {
  if (shape == ProbeShape{}) return "point";
  const KindText& kind = kinds.at(static_cast<std::size_t>(shape.kind));
  std::string text(kind.word);
  text.append(":").append(format_quantity(shape.radius, Quantity::length));
  if (kind.has_length) text.append(",").append(format_quantity(shape.length, Quantity::length));
  return text;
}

}  // namespace spm
