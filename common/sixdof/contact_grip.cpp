// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/contact_grip.hpp"

#include <algorithm>
#include <bit>

#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

Vector3 along_surface(const Vector3& v, const Vector3& normal) noexcept {
  return v - normal.dot(v) * normal;
}

}  // namespace

ContactGrip::ContactGrip(std::size_t samples, std::size_t objects)
    : anchors_(std::bit_ceil(std::clamp<std::size_t>(samples / 8, 256, 4096))), means_(objects) {}

std::size_t ContactGrip::slot_of(std::uint32_t sample, std::uint32_t object) const noexcept {
  constexpr std::uint32_t spread = 0x9E3779B1U;
  return (sample + object * spread) & (anchors_.size() - 1);
}

const ContactGrip::Anchor* ContactGrip::find(std::uint32_t sample,
                                             std::uint32_t object) const noexcept {
  const std::size_t slot = slot_of(sample, object);
  for (std::size_t k = 0; k < tried; ++k) {
    const Anchor& anchor = anchors_[(slot + k) & (anchors_.size() - 1)];
    if (anchor.sample == sample && anchor.object == object && now_ - anchor.seen <= kept_ticks) {
      return &anchor;
    }
  }
  return nullptr;
}

/// The anchor of a sample, or the place of the one that was seen longest ago.
ContactGrip::Anchor& ContactGrip::make(std::uint32_t sample, std::uint32_t object) noexcept {
  const std::size_t slot = slot_of(sample, object);
  Anchor* oldest = &anchors_[slot];
  for (std::size_t k = 0; k < tried; ++k) {
    Anchor& anchor = anchors_[(slot + k) & (anchors_.size() - 1)];
    if (anchor.sample == sample && anchor.object == object) return anchor;
    if (anchor.seen < oldest->seen) oldest = &anchor;
  }
  return *oldest;
}

Bristle ContactGrip::bristle(std::uint32_t sample, std::uint32_t object, const Vector3& place,
                             const Vector3& before, const Vector3& normal) const noexcept {
  Bristle bristle;
  if (const Anchor* anchor = find(sample, object)) {
    bristle.stretch =
        along_surface(place - vector_of(anchor->place) - vector_of(anchor->away), normal);
    bristle.most = static_cast<double>(anchor->most);
    return bristle;
  }
  const Mean& mean = means_[object];
  if (!(mean.most > 0)) return bristle;
  bristle.stretch = along_surface(place - before + mean.stretch, normal);
  bristle.most = mean.most;
  return bristle;
}

void ContactGrip::begin(std::uint32_t object) noexcept {
  Mean& mean = means_[object];
  mean.sum.setZero();
  mean.weight = mean.load = 0;
  mean.count = 0;
}

void ContactGrip::settle(const GripSettings& settings, std::uint32_t sample, std::uint32_t object,
                         const Vector3& place, const Vector3& before, const Vector3& normal,
                         double force, double spring) noexcept {
  Bristle now = bristle(sample, object, place, before, normal);
  const double pull = spring * now.stretch.norm();
  const Anchor* const before_now = find(sample, object);
  // Once it gives way it slides with the smaller force, until it pulls with less.
  bool sliding = before_now != nullptr && before_now->sliding;
  const double mu = sliding ? settings.slide : std::max(settings.stick, settings.slide);
  if (pull > mu * force) {
    sliding = true;
    now.stretch *= settings.slide * force / pull;
  } else if (pull < settings.slide * force) {
    sliding = false;
  }
  const double most = (sliding ? settings.slide : std::max(settings.stick, settings.slide)) * force;
  const bool stays = pull <= mu * force && before_now != nullptr;
  Anchor& anchor = make(sample, object);
  anchor.sliding = sliding;
  anchor.sample = sample;
  anchor.object = object;
  if (!stays) {
    // Written only where it moves: rounding would make it creep.
    anchor.place = floats_of(place);
    anchor.away = floats_of(-now.stretch);
  }
  anchor.most = static_cast<float>(most);
  anchor.seen = now_;
  Mean& mean = means_[object];
  mean.sum += spring * now.stretch;
  mean.weight += spring;
  mean.load += most;
  ++mean.count;
  mean.anchored = true;
}

void ContactGrip::end(std::uint32_t object) noexcept {
  Mean& mean = means_[object];
  mean.stretch = mean.weight > 0 ? Vector3(mean.sum / mean.weight) : Vector3(Vector3::Zero());
  mean.most = mean.count > 0 ? mean.load / mean.count : 0;
  mean.all = mean.load;
}

void ContactGrip::forget(std::uint32_t object) noexcept {
  const bool anchored = means_[object].anchored;
  means_[object] = {};
  // All anchors of every object that a tick forgets would be too many to look through.
  if (!anchored) return;
  for (Anchor& anchor : anchors_) {
    if (anchor.object == object) anchor = {};
  }
}

}  // namespace spm
