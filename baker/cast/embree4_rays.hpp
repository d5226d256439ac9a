// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <embree4/rtcore.h>

namespace spm::baker {

/// What a filter of hits is handed with each of them.
using RayContext = RTCRayQueryContext;

/// The flag of a scene whose rays bring their filter along.
inline constexpr RTCSceneFlags filtered_rays = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

/// Looks for the first hit of a ray.
inline void find_hit(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray); }

/// The same, of those hits that `filter` lets pass.
inline void find_hit(RTCScene scene, RTCRayHit& ray, RayContext& context,
                     RTCFilterFunctionN filter) {
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = static_cast<RTCRayQueryFlags>(RTC_RAY_QUERY_FLAG_INCOHERENT |
                                                  RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
  arguments.context = &context;
  arguments.filter = filter;
  rtcIntersect1(scene, &ray, &arguments);
}

}  // namespace spm::baker
