// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/paper/implicit_probe.hpp"

namespace spm {

/// The kinds of probes that options, scenes and recordings can name. A further one is a row here,
/// a row of the table in probe_shape.cpp, and a case of `with_probe`; see PROBES.md.
enum class ProbeKind : std::uint8_t { ball, capsule };

/// Form and size of a probe, wherever it is. A ball of radius 0 is a point.
struct ProbeShape {
  ProbeKind kind = ProbeKind::ball;
  double radius = 0;  ///< m, 0 or more; above 0 for all but a point
  double length = 0;  ///< m, of a capsule: from the centre of one end to that of the other

  /// Whether only the paper's equations know it (section 3.2); a ball every method does.
  [[nodiscard]] bool paper_only() const noexcept { return kind != ProbeKind::ball; }
  [[nodiscard]] bool operator==(const ProbeShape&) const = default;
};

/// What may be written for a probe, for messages and help.
inline constexpr const char* probe_forms = "point|sphere:RADIUS|capsule:RADIUS,LENGTH";

/// Reads "point", "sphere:0.5mm" or "capsule:0.5mm,10mm", the last with its radius and the length
/// of its axis. Errors: usage, with the cure, for anything else, a size that is missing, and one
/// that is not above 0.
[[nodiscard]] Result<ProbeShape> parse_probe_shape(std::string_view text);

/// The same back, such as "sphere:0.5 mm".
[[nodiscard]] std::string text_of(const ProbeShape& shape);

/// Calls `use` with the probe in implicit form, its middle at `centre`, m, and gives what it gives.
/// `axis`, of unit length, is along its long side. Does not allocate.
template <class Use>
[[nodiscard]] auto with_probe(const ProbeShape& shape, const Vector3& centre, const Vector3& axis,
                              const Use& use) noexcept {
  if (shape.kind == ProbeKind::capsule) {
    const Vector3 half = shape.length / 2 * axis;
    return use(CapsuleProbe(centre - half, centre + half, shape.radius));
  }
  return use(SphereProbe(centre, shape.radius));
}

}  // namespace spm
