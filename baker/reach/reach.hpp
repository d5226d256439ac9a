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
  probe,        ///< the probe is too big to come there
  unreachable,  ///< in a sealed hollow, where not even a point comes
};

/// The rule's word in reports: none, workspace, probe or unreachable.
[[nodiscard]] const char* name_of(PruneRule rule) noexcept;

/// Which places the probe's centre can come to, for leaving out the others. A probe moves freely
/// where it does not overlap the solid, starting anywhere outside the object, and is pressed from
/// there by at most max_depth. So its centre comes to a place where a free one that leads outside
/// is no farther than max_depth; and the whole band of surface that it touches there is kept. This
/// holds whether max_depth is more or less than the radius: a probe is not pressed through what it
/// does not fit through, however deep the band. Too much is taken for reached rather than too
/// little. Where the workspace lies wholly in a hollow that has no such way, the probe starts
/// there.
///
/// The rules `probe` and `unreachable` are for the band: what is wholly deeper than max_depth has
/// its own answer (`deep`) and gives none. For a point without a workspace all this costs next to
/// nothing, unless the object has sealed hollows.
class Reach {
 public:
  /// Lengths in metres, the workspace in the asset's frame. Keeps a reference to the caster. The
  /// same for any number of threads.
  Reach(const Caster& caster, const Band& band, double probe_radius,
        const std::optional<OrientedBox>& workspace, const Progress& progress);
  ~Reach();
  Reach(const Reach&) = delete;
  Reach& operator=(const Reach&) = delete;

  /// Why a cube (axis-aligned, middle and edge, m) need not be modelled; none where the probe's
  /// centre can come into it.
  [[nodiscard]] PruneRule cube(const Vector3& middle, double edge) const;

  /// False where nothing is left out for sure.
  [[nodiscard]] bool cuts() const;
  /// Whether a rule might cut: it has a workspace, a ball or a sealed hollow to look at.
  [[nodiscard]] bool looks_at(PruneRule rule) const;

  /// The rule that most likely left out what no single place tells.
  [[nodiscard]] PruneRule likeliest() const;

  /// The same for a single place.
  [[nodiscard]] PruneRule point(const Vector3& place) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace spm::baker
