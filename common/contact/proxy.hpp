// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"

namespace spm {

/// Position of the proxy at the end of the last tick, in the object's frame, so that an object that
/// moves takes it along.
struct ProxyState {
  bool known = false;
  Vector3 position = Vector3::Zero();  ///< m
  Vector3 hand = Vector3::Zero();      ///< m, the haptic interaction point of that tick
  bool touching = false;               ///< there was contact
};

/// Position of the proxy now, and the contact that holds it back.
struct ProxyContact {
  Vector3 proxy = Vector3::Zero();   ///< m, object's frame
  Vector3 normal = Vector3::Zero();  ///< unit, from the haptic interaction point to the proxy; zero
                                     ///< without contact
  double depth = 0;                  ///< m, distance of the two in contact
  bool contact = false;
  std::uint32_t queries = 0;  ///< number of queries made
};

/// Length of the steps that a proxy takes without knowledge of the surface on the way, m. A plate
/// that is thicker than this is never passed; for a ball, thicker than its diameter and this
/// together.
inline constexpr double proxy_blind_step = 80e-6;
/// Limits of a proxy's motion in a tick after one in contact: at most proxy_catch_up_share times as
/// far as the hand, plus proxy_catch_up, m. So a proxy that was caught and comes free catches up
/// over several ticks, and the force falls without a jump.
inline constexpr double proxy_catch_up = 150e-6;
inline constexpr double proxy_catch_up_share = 1.5;
/// Largest number of surface queries in a tick where the proxy touches, and in any tick.
inline constexpr std::uint32_t proxy_touching_queries = 32;
inline constexpr std::uint32_t proxy_queries = 128;
/// The same for a tick that is short of time.
inline constexpr std::uint32_t proxy_few_queries = 12;

/// Moves the proxy of a point (radius 0) or a ball towards the haptic interaction point (object's
/// frame, m) as far as the surface allows: to the nearest place outside, as seen from the proxy's
/// last position. So the proxy stays on the side that it came from, however deep the hand is, and
/// slides along walls and in grooves (god-object, Zilles and Salisbury 1995; a ball, Ruspini et al.
/// 1997).
///
/// A step is no longer than the distance to the surface, or proxy_blind_step. A step that would not
/// end outside is not taken, nor one past the middle of a wall. If a tick does not reach the goal,
/// the next one continues. There is contact where the surface holds the proxy, and until the proxy
/// has caught up. A proxy that is not known starts at the point, or at the surface nearest to it;
/// where neither is outside, it stays unknown after the tick. Places that the bake left out count
/// as empty. Points that are not finite give no contact and reset the proxy. No step is begun after
/// `most` queries.
[[nodiscard]] ProxyContact move_proxy(const AssetView& asset, double radius, const Vector3& point,
                                      ProxyState& state,
                                      std::uint32_t most = proxy_queries) noexcept;

}  // namespace spm
