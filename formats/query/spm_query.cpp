// SPDX-License-Identifier: Apache-2.0
#include "spm_query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <span>
#include <string>

#include "common/contact/force_law.hpp"
#include "common/query/query.hpp"
#include "formats/asset/mapped_asset.hpp"

struct spm_query_asset {
  std::unique_ptr<spm::MappedAsset> asset;
  const spm::AssetView* view = nullptr;  ///< the asset's
};

namespace {

using spm::Vector3;

void give_message(char* message, size_t size, const std::string& text) noexcept {
  if (message == nullptr || size == 0) return;
  const size_t count = std::min(size - 1, text.size());
  std::memcpy(message, text.data(), count);
  message[count] = '\0';
}

Vector3 vector_from(const double* values) noexcept { return {values[0], values[1], values[2]}; }

void copy_to(double* values, const Vector3& vector) noexcept {
  for (int axis = 0; axis < 3; ++axis) values[axis] = vector[axis];
}

int32_t status_code(spm::Status status) noexcept {
  switch (status) {
    case spm::Status::exact:
      return SPM_QUERY_EXACT;
    case spm::Status::deep:
      return SPM_QUERY_DEEP;
    case spm::Status::far:
      return SPM_QUERY_FAR;
    case spm::Status::pruned:
      return SPM_QUERY_PRUNED;
  }
  return SPM_QUERY_FAR;
}

int32_t source_code(spm::Source source) noexcept {
  switch (source) {
    case spm::Source::map:
      return SPM_QUERY_TILE;
    case spm::Source::triangles:
      return SPM_QUERY_TRIANGLES;
    case spm::Source::none:
      return SPM_QUERY_NONE;
  }
  return SPM_QUERY_NONE;
}

void copy_to(spm_query_answer& answer, const spm::Answer& found) noexcept {
  answer.distance = found.distance;
  copy_to(answer.normal, found.normal);
  answer.plane = found.plane;
  answer.layer = found.layer;
  answer.source = source_code(found.source);
  answer.status = status_code(found.status);
}

/// Whether the members that version 2 added are in range; they are not to be read for other
/// methods.
bool probe_in_range(const spm_query_force_settings& settings) noexcept {
  const bool ball = settings.probe == SPM_QUERY_PROBE_BALL;
  const bool capsule = settings.probe == SPM_QUERY_PROBE_CAPSULE && settings.probe_radius > 0 &&
                       settings.probe_length > 0 && std::isfinite(settings.probe_length);
  const bool surface = settings.form == SPM_QUERY_FORM_SURFACE;
  const bool volume = settings.form == SPM_QUERY_FORM_VOLUME && settings.probe_radius > 0;
  return (ball || capsule) && (surface || volume) && vector_from(settings.probe_axis).allFinite();
}

bool in_range(const spm_query_asset* asset, const spm_query_force_settings& settings) noexcept {
  const bool probe = settings.method == SPM_QUERY_METHOD_PAPER_PROBE;
  const bool paper = probe || settings.method == SPM_QUERY_METHOD_PAPER;
  return std::isfinite(settings.stiffness) && settings.stiffness >= 0 &&
         settings.probe_radius >= 0 &&
         settings.probe_radius <= asset->asset->metadata().probe_radius &&
         (paper || settings.method == SPM_QUERY_METHOD_SPM) &&
         !(paper && !asset->asset->view().full) && (!probe || probe_in_range(settings));
}

/// Settings that are in range, as the force law has them.
spm::ForceSettings law_of(const spm_query_force_settings& settings) noexcept {
  spm::ForceSettings law;
  law.stiffness = settings.stiffness;
  law.probe_radius = settings.probe_radius;
  if (settings.method != SPM_QUERY_METHOD_SPM) law.method = spm::Method::paper;
  if (settings.method != SPM_QUERY_METHOD_PAPER_PROBE) return law;
  if (settings.form == SPM_QUERY_FORM_VOLUME) law.form = spm::PaperProbeForm::volume;
  if (settings.probe == SPM_QUERY_PROBE_CAPSULE) {
    law.probe_kind = spm::ProbeKind::capsule;
    law.probe_length = settings.probe_length;
    const Vector3 axis = vector_from(settings.probe_axis);
    // Not the squared length, which may be 0 or infinite where the length is not.
    const double size = axis.stableNorm();
    if (size > 0) law.probe_axis = axis / size;
  }
  return law;
}

}  // namespace

int spm_query_open(const char* path, spm_query_asset** asset, char* message, size_t message_size) {
  constexpr int usage = static_cast<int>(spm::ExitCode::usage);
  constexpr int internal = static_cast<int>(spm::ExitCode::internal);
  if (message != nullptr && message_size > 0) message[0] = '\0';
  if (asset != nullptr) *asset = nullptr;
  if (path == nullptr || asset == nullptr) {
    return usage;
  }
  try {
    spm::MapOptions options;
    options.prefault = true;
    auto opened = spm::MappedAsset::open(path, options);
    if (!opened) {
      give_message(message, message_size, opened.error().message);
      return static_cast<int>(opened.error().code);
    }
    const spm::AssetView* const view = &(*opened)->view();
    *asset = new spm_query_asset{std::move(*opened), view};
    return 0;
  } catch (const std::exception& problem) {
    if (message != nullptr && message_size > 0) {
      std::strncpy(message, problem.what(), message_size - 1);
      message[message_size - 1] = '\0';
    }
    return internal;
  } catch (...) {
    return internal;
  }
}

void spm_query_close(spm_query_asset* asset) { delete asset; }

int spm_query_lost(const spm_query_asset* asset) { return asset->asset->lost() ? 1 : 0; }

void spm_query_band(const spm_query_asset* asset, double* max_depth, double* margin) {
  *max_depth = asset->asset->view().band.max_depth;
  *margin = asset->asset->view().band.margin;
}

size_t spm_query_memory(const spm_query_asset* asset) { return asset->asset->resident_bytes(); }

void spm_query_box(const spm_query_asset* asset, double box_min[3], double box_max[3]) {
  copy_to(box_min, asset->asset->metadata().box_min);
  copy_to(box_max, asset->asset->metadata().box_max);
}

void spm_query_point(const spm_query_asset* asset, const double point[3],
                     spm_query_answer* answer) {
  copy_to(*answer, spm::query_point(*asset->view, vector_from(point)));
}

void spm_query_batch(const spm_query_asset* asset, const double* points, size_t count,
                     spm_query_answer* answers) {
  constexpr size_t most = 64;
  std::array<spm::Vector3, most> places;
  std::array<spm::Answer, most> found;
  for (size_t first = 0; first < count; first += most) {
    const size_t some = std::min(most, count - first);
    for (size_t i = 0; i < some; ++i) places[i] = vector_from(points + 3 * (first + i));
    spm::query_points(*asset->view, std::span(places).first(some), std::span(found).first(some));
    for (size_t i = 0; i < some; ++i) copy_to(answers[first + i], found[i]);
  }
}

int spm_query_force(const spm_query_asset* asset, const spm_query_force_settings* settings,
                    const double point[3], spm_query_contact* contact) {
  *contact = {};
  if (!in_range(asset, *settings)) return 1;
  const spm::ContactForce found =
      spm::contact_force(asset->asset->view(), law_of(*settings), vector_from(point));
  copy_to(contact->force, found.force);
  copy_to(contact->normal, found.normal);
  contact->depth = found.depth;
  contact->contact = found.contact ? 1 : 0;
  contact->deep = found.deep ? 1 : 0;
  return 0;
}
