// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <embree3/rtcore.h>

namespace spm::baker {

/// What a filter of hits is handed with each of them.
using RayContext = RTCIntersectContext;

/// The flag of a scene whose rays bring their filter along.
inline constexpr RTCSceneFlags filtered_rays = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

/// Looks for the first hit of a ray.
inline void find_hit(RTCScene scene, RTCRayHit& ray) {
  RayContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
}

/// The same, of those hits that `filter` lets pass.
inline void find_hit(RTCScene scene, RTCRayHit& ray, RayContext& context,
                     RTCFilterFunctionN filter) {
  rtcInitIntersectContext(&context);
  context.filter = filter;
  rtcIntersect1(scene, &context, &ray);
}

}  // namespace spm::baker
