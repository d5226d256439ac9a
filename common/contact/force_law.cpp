// SPDX-License-Identifier: Apache-2.0
#include "common/contact/force_law.hpp"

namespace spm {

namespace {

ContactForce paper_contact_force(const AssetView& asset, const ForceSettings& settings,
                                 const Vector3& point) noexcept {
  const PaperContact found = paper_contact(asset, point, settings.rule);
  ContactForce result;
  if (!found.contact) return result;
  result.force = paper_force(found, settings.stiffness);
  result.normal = found.normal;
  result.depth = found.depth;
  result.contact = true;
  return result;
}

/// Depth and normal of the mean that eq. 10 and 11, or their form over the volume, make.
ContactForce paper_probe_contact_force(const AssetView& asset, const ForceSettings& settings,
                                       const Vector3& point) noexcept {
  const Vector3 mean = with_probe(
      settings.probe(), point, settings.probe_axis, [&](const ImplicitProbe& probe) -> Vector3 {
        return settings.form == PaperProbeForm::volume ? paper_probe_volume_force(asset, probe, 1)
                                                       : paper_probe_force(asset, probe, 1).force;
      });
  ContactForce result;
  const double depth = mean.norm();
  if (!(depth > 0)) return result;
  result.normal = mean / depth;
  result.depth = depth;
  result.force = settings.stiffness * mean;
  result.contact = true;
  return result;
}

ContactForce spm_contact_force(const AssetView& asset, const ForceSettings& settings,
                               const Vector3& point) noexcept {
  const Answer answer = query_point(asset, point);
  ContactForce result;
  const bool answered = is_known(answer.status);
  if (!answered || !(answer.distance < settings.probe_radius)) return result;
  result.depth = settings.probe_radius - answer.distance;
  result.normal = answer.normal;
  result.force = settings.stiffness * result.depth * answer.normal;
  result.contact = true;
  result.deep = answer.status == Status::deep;
  return result;
}

}  // namespace

ContactForce smoothed_force(const AssetView& asset, const ForceSettings& settings,
                            const RuntimeSmoothing& smoothing, const Vector3& point) noexcept {
  if (!point.allFinite()) return {};
  const SmoothedAnswer answer = smoothed_query(asset, smoothing, point);
  ContactForce result;
  const double slope = answer.gradient.norm();
  if (!answer.known || !(answer.distance < settings.probe_radius) || !(slope > 0)) return result;
  result.depth = (settings.probe_radius - answer.distance) * slope;
  result.normal = answer.gradient / slope;
  result.force = settings.stiffness * result.depth * result.normal;
  result.contact = true;
  result.deep = answer.deep;
  return result;
}

ContactForce contact_force(const AssetView& asset, const ForceSettings& settings,
                           const Vector3& point) noexcept {
  if (!point.allFinite()) return {};
  ContactForce result;
  if (settings.method != Method::paper) {
    result = spm_contact_force(asset, settings, point);
  } else if (settings.probe_radius > 0) {
    result = paper_probe_contact_force(asset, settings, point);
  } else {
    result = paper_contact_force(asset, settings, point);
  }
  if (!result.force.allFinite()) return {};
  return result;
}

}  // namespace spm
