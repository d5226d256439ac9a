// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "common/asset/asset_view.hpp"

namespace spm {

/// Where the proxy was at the end of the last tick; in the object's frame, so that an object that
/// moves takes it along.
struct ProxyState {
  bool known = false;
  Vector3 position = Vector3::Zero();  ///< m
  Vector3 hand = Vector3::Zero();      ///< m, the haptic interaction point then
  bool touching = false;               ///< there was contact
};

/// Where the proxy is now, and what holds it back.
struct ProxyContact {
  Vector3 proxy = Vector3::Zero();   ///< m, object's frame
  Vector3 normal = Vector3::Zero();  ///< unit, from the haptic interaction point to the proxy; zero
                                     ///< without contact
  double depth = 0;                  ///< m, how far apart the two are in contact
  bool contact = false;
  std::uint32_t queries = 0;  ///< that were asked
};

/// The steps that a proxy takes without knowing the surface on the way, m: a plate is never passed
/// that is thicker than this, or than the probe's diameter and this.
inline constexpr double proxy_blind_step = 80e-6;
/// How many times as far as the hand a proxy moves in a tick that was in contact before it, and how
/// much farther, m: where it was caught and comes free, it catches up within some ticks, with a
/// force that falls and does not jump.
inline constexpr double proxy_catch_up = 150e-6;
inline constexpr double proxy_catch_up_share = 1.5;
/// Queries of the surface in a tick at most, where the proxy touches; and in all.
inline constexpr std::uint32_t proxy_touching_queries = 32;
inline constexpr std::uint32_t proxy_queries = 128;

/// Moves the proxy of a point (radius 0) or a ball towards the haptic interaction point (object's
/// frame, m) as far as the surface lets it: to the place outside that is nearest, as seen from
/// where it was. So it keeps to the side that it came from, whatever the depth of the hand, and
/// slides along walls and in grooves (god-object, Zilles and Salisbury 1995; a ball, Ruspini et al.
/// 1997).
///
/// Steps are no longer than the way to the surface, or proxy_blind_step; each ends outside, or is
/// not taken. What a tick does not reach the next one does; there is contact where the surface
/// holds the proxy, and until it has caught up. A proxy that is not known begins at the point, or
/// at the surface nearest to it; where neither is outside, it is not known after the tick. Places
/// that the bake left out are taken as empty. Points that are not finite give no contact and forget
/// the proxy.
[[nodiscard]] ProxyContact move_proxy(const AssetView& asset, double radius, const Vector3& point,
                                      ProxyState& state) noexcept;

}  // namespace spm
