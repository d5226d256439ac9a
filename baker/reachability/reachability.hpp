// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "baker/base/oriented_box.hpp"
#include "baker/base/progress.hpp"
#include "baker/cast/cast.hpp"
#include "common/asset/asset_view.hpp"

namespace spm::baker {

/// Why a place need not be modelled.
enum class PruneRule : std::uint8_t {
  none,
  workspace,    ///< outside the device's workspace
  probe,        ///< the probe is too large to come there
  unreachable,  ///< in a sealed hollow, where not even a point comes
};

/// The rule's name in reports: none, workspace, probe or unreachable.
[[nodiscard]] const char* name_of(PruneRule rule) noexcept;

/// Reachability: which places the probe's centre can come to. The others can be left out. A probe
/// starts anywhere outside the object, and moves freely where it does not overlap the solid. From
/// there it is pressed in by at most max_depth. So its centre can come to a place if a free place
/// with a way to the outside is at most max_depth away. All of the band of surface that the probe
/// touches there is kept. This holds whether max_depth is more or less than the radius: a probe is
/// not pressed through what it does not fit through, however deep the band is. In doubt a place
/// counts as reachable. Where the workspace lies wholly in a hollow without a way to the outside,
/// the probe starts there.
///
/// The rules `probe` and `unreachable` are for the band. What is wholly deeper than max_depth has
/// its own answer (`deep`), and neither rule leaves it out. For a point without a workspace all
/// this costs next to nothing, unless the object has sealed hollows.
class Reachability {
 public:
  /// Lengths in metres, the workspace in the asset's frame. Keeps a reference to the caster. The
  /// result is the same for any number of threads.
  Reachability(const Caster& caster, const Band& band, double probe_radius,
               const std::optional<OrientedBox>& workspace, const Progress& progress);
  ~Reachability();
  Reachability(const Reachability&) = delete;
  Reachability& operator=(const Reachability&) = delete;

  /// Why a cube (axis-aligned, middle and edge, m) need not be modelled. `none` where the probe's
  /// centre can come into it.
  [[nodiscard]] PruneRule cube(const Vector3& middle, double edge) const;

  /// False where it is certain that nothing is left out.
  [[nodiscard]] bool cuts() const;
  /// Whether a rule may leave something out: there is a workspace, a ball or a sealed hollow to
  /// check.
  [[nodiscard]] bool checks(PruneRule rule) const;

  /// Why a single place need not be modelled.
  [[nodiscard]] PruneRule point(const Vector3& place) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace spm::baker
