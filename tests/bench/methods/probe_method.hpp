// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "tests/bench/model/baked_file.hpp"
#include "tests/bench/model/model.hpp"

namespace spm::bench {

/// A method that computes the contact depth of a ball. Not thread-safe.
class ProbeMethod {
 public:
  ProbeMethod() = default;
  virtual ~ProbeMethod() = default;
  ProbeMethod(const ProbeMethod&) = delete;
  ProbeMethod& operator=(const ProbeMethod&) = delete;

  /// Depth of the ball's deepest contact when its centre is at `centre`, m; 0 without contact.
  [[nodiscard]] virtual double depth(const Vector3& centre) = 0;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const std::string& settings() const noexcept { return settings_; }

 protected:
  ProbeMethod(std::string name, std::string settings)
      : name_(std::move(name)), settings_(std::move(settings)) {}

 private:
  std::string name_;
  std::string settings_;
};

// `radius` is in metres; for `spm` at most the margin of the band. Defined in the method files.

/// The product's force for a ball on a baked file. Throws BakeError.
[[nodiscard]] std::unique_ptr<ProbeMethod> make_spm_probe(const BakedFile& file, double radius);

/// FCL's contacts of a ball and the mesh.
[[nodiscard]] std::unique_ptr<ProbeMethod> make_fcl_probe(const Model& model, double radius);

/// Bullet's contacts of a ball and the mesh.
[[nodiscard]] std::unique_ptr<ProbeMethod> make_bullet_probe(const Model& model, double radius);

}  // namespace spm::bench
