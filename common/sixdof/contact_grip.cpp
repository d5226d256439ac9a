// SPDX-License-Identifier: Apache-2.0
#include "common/sixdof/contact_grip.hpp"

#include <algorithm>
#include <bit>

#include "common/sixdof/sample_vectors.hpp"

namespace spm {

namespace {

/// Of a pull: what an anchor of floats does not tell.
constexpr double rounding = 1e-6;

Vector3 along_surface(const Vector3& v, const Vector3& normal) noexcept {
  return v - normal.dot(v) * normal;
}

}  // namespace

ContactGrip::ContactGrip(std::size_t samples, std::size_t objects)
    : anchors_(std::bit_ceil(std::clamp<std::size_t>(4 * samples, 256, 4096))), means_(objects) {}

std::size_t ContactGrip::slot_of(std::uint32_t sample, std::uint32_t object) const noexcept {
  // Fibonacci hashing: samples in a row, of several objects, are spread over all slots.
  constexpr std::uint32_t spread = 0x9E3779B1U, apart = 0x85EBCA6BU;
  const std::uint32_t mixed = (sample + object * apart) * spread;
  return mixed >> (std::countl_zero(static_cast<std::uint32_t>(anchors_.size())) + 1);
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

Bristle ContactGrip::bristle_at(const Anchor* anchor, std::uint32_t object, const Vector3& place,
                                const Vector3& before, const Vector3& normal) const noexcept {
  Bristle bristle;
  if (anchor != nullptr) {
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

Bristle ContactGrip::bristle(std::uint32_t sample, std::uint32_t object, const Vector3& place,
                             const Vector3& before, const Vector3& normal,
                             double coarse) const noexcept {
  const Anchor* const anchor = find(sample, object);
  Bristle bristle = bristle_at(anchor, object, place, before, normal);
  const double mean = means_[object].spring;
  if (anchor == nullptr && coarse > mean && mean > 0) bristle.most *= coarse / mean;
  return bristle;
}

void ContactGrip::begin(std::uint32_t object) noexcept {
  Mean& mean = means_[object];
  mean.sum.setZero();
  mean.weight = mean.load = mean.pressed = 0;
  mean.count = 0;
}

void ContactGrip::settle(const GripSettings& settings, std::uint32_t sample, std::uint32_t object,
                         const Vector3& place, const Vector3& before, const Vector3& normal,
                         double force, double spring) noexcept {
  const Anchor* const known = find(sample, object);
  Bristle now = bristle_at(known, object, place, before, normal);
  const double pull = spring * now.stretch.norm();
  // Once it gives way it slides with the smaller force, until it pulls with less.
  Anchor settled = known != nullptr ? *known : Anchor{sample, object};
  const double stick = std::max(settings.stick, settings.slide) * force,
               slide = settings.slide * force;
  const bool gives_way = pull > (settled.sliding ? slide : stick) * (1 + rounding);
  if (gives_way) {
    now.stretch *= slide / pull;
    settled.sliding = true;
  } else if (pull < slide * (1 - rounding)) {
    settled.sliding = false;
  }
  if (gives_way || known == nullptr) {
    // Written only where it moves: rounding would make it creep.
    settled.place = floats_of(place);
    settled.away = floats_of(place - vector_of(settled.place) - now.stretch);
  }
  const double most = settled.sliding ? slide : stick;
  settled.most = static_cast<float>(most);
  settled.seen = now_;
  moved_ = moved_ || known == nullptr || !settled.rests_as(*known);
  make(sample, object) = settled;
  Mean& mean = means_[object];
  mean.sum += spring * now.stretch;
  mean.weight += spring;
  mean.load += most;
  mean.pressed += force;
  ++mean.count;
  mean.anchored = true;
}

void ContactGrip::end(std::uint32_t object, double pressed) noexcept {
  Mean& mean = means_[object];
  mean.stretch = mean.weight > 0 ? Vector3(mean.sum / mean.weight) : Vector3(Vector3::Zero());
  mean.most = mean.count > 0 ? mean.load / mean.count : 0;
  mean.spring = mean.count > 0 ? mean.weight / mean.count : 0;
  const double all =
      mean.pressed > 0 ? mean.load * std::max(1.0, pressed / mean.pressed) : mean.load;
  moved_ = moved_ || mean.all != all;
  mean.all = all;
}

void ContactGrip::forget(std::uint32_t object) noexcept {
  const bool anchored = means_[object].anchored;
  means_[object] = {};
  moved_ = true;
  // All anchors of every object that a tick forgets would be too many to look through.
  if (!anchored) return;
  for (Anchor& anchor : anchors_) {
    if (anchor.object == object) anchor = {};
  }
}

}  // namespace spm
