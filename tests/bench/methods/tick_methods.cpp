// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/tick_methods.hpp"

#include <cstdint>
#include <vector>

#include "common/paper/paper_force.hpp"
#include "servo/force/contact_model.hpp"
#include "tests/bench/base/timing.hpp"

namespace spm::bench {
namespace {

constexpr double stiffness = 1e3;  // N/m
constexpr std::uint32_t nothing = 0xFFFFFFFFU;

/// What a search found at each tick.
class Given : public TickMethod {
 public:
  [[nodiscard]] bool counts(std::size_t index) const override { return found_[index] != nothing; }

 protected:
  std::vector<std::uint32_t> found_;
};

class ProxyTicks final : public TickMethod {
 public:
  explicit ProxyTicks(MeshProxy& proxy) : proxy_(proxy) {}
  void start(const Vector3& first) override { proxy_.place(first); }
  bool tick(std::size_t, const Vector3& tool) override {
    const ProxyContact contact = proxy_.follow(tool);
    keep(contact.force);
    return contact.contact;
  }

 private:
  MeshProxy& proxy_;
};

class ProxyTicksGiven final : public Given {
 public:
  ProxyTicksGiven(MeshProxy& proxy, std::span<const Vector3> path) : proxy_(proxy) {
    proxy.place(path.front());
    for (const Vector3& tool : path) {
      found_.push_back(proxy.follow(tool).contact ? proxy.last_triangle() : nothing);
    }
  }
  bool tick(std::size_t index, const Vector3& tool) override {
    if (!counts(index)) return false;
    const ProxyContact contact = proxy_.force_at(tool, found_[index]);
    keep(contact.force);
    return contact.contact;
  }

 private:
  MeshProxy& proxy_;
};

class PaperTicks final : public TickMethod {
 public:
  explicit PaperTicks(const AssetView& asset) : asset_(asset) {}
  bool tick(std::size_t, const Vector3& tool) override {
    const PaperContact contact = paper_contact(asset_, tool, PaperRule::closest_plane);
    keep(paper_force(contact, stiffness));
    return contact.contact;
  }

 private:
  const AssetView& asset_;
};

class PaperTicksGiven final : public Given {
 public:
  PaperTicksGiven(const AssetView& asset, std::span<const Vector3> path) : asset_(asset) {
    for (const Vector3& tool : path) {
      const PaperContact contact = paper_contact(asset, tool, PaperRule::closest_plane);
      found_.push_back(contact.contact ? contact.plane : nothing);
    }
  }
  bool tick(std::size_t index, const Vector3& tool) override {
    if (!counts(index)) return false;
    const PaperContact contact = paper_contact_on_plane(asset_, found_[index], tool);
    keep(paper_force(contact, stiffness));
    return contact.contact;
  }

 private:
  const AssetView& asset_;
};

class SpmTicks final : public TickMethod {
 public:
  SpmTicks(const spm_query_asset& asset, double radius) : asset_(asset) {
    settings_.stiffness = stiffness;
    settings_.probe_radius = radius;
  }
  bool tick(std::size_t, const Vector3& tool) override {
    spm_query_contact contact;
    static_cast<void>(spm_query_force(&asset_, &settings_, tool.data(), &contact));
    keep(contact);
    return contact.contact != 0;
  }

 private:
  const spm_query_asset& asset_;
  spm_query_force_settings settings_{};
};

class OwnProxyTicks final : public TickMethod {
 public:
  OwnProxyTicks(const AssetView& asset, double radius)
      : asset_(asset), model_(settings_of(radius)) {}
  void start(const Vector3&) override { model_.reset(); }
  bool tick(std::size_t, const Vector3& tool) override {
    const ContactForce contact = model_.next(asset_, tool);
    keep(contact.force);
    return contact.contact;
  }

 private:
  static ContactSettings settings_of(double radius) {
    ContactSettings settings;
    settings.force.method = ::spm::Method::proxy;  // the bench has a `Method` of its own
    settings.force.stiffness = stiffness;
    settings.force.probe_radius = radius;
    return settings;
  }

  const AssetView& asset_;
  ContactModel model_;
};

}  // namespace

std::unique_ptr<TickMethod> proxy_ticks(MeshProxy& proxy) {
  return std::make_unique<ProxyTicks>(proxy);
}

std::unique_ptr<TickMethod> proxy_ticks_given(MeshProxy& proxy, std::span<const Vector3> path) {
  return std::make_unique<ProxyTicksGiven>(proxy, path);
}

std::unique_ptr<TickMethod> paper_ticks(const AssetView& asset) {
  return std::make_unique<PaperTicks>(asset);
}

std::unique_ptr<TickMethod> paper_ticks_given(const AssetView& asset,
                                              std::span<const Vector3> path) {
  return std::make_unique<PaperTicksGiven>(asset, path);
}

std::unique_ptr<TickMethod> spm_ticks(const spm_query_asset& asset, double radius) {
  return std::make_unique<SpmTicks>(asset, radius);
}

std::unique_ptr<TickMethod> own_proxy_ticks(const AssetView& asset, double radius) {
  return std::make_unique<OwnProxyTicks>(asset, radius);
}

}  // namespace spm::bench
