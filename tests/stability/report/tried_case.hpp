// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "tests/stability/laboratory/laboratory.hpp"
#include "tests/stability/objects/stability_case.hpp"
#include "tests/stability/sixdof/sixdof_case.hpp"
#include "tests/stability/sixdof/sixdof_scene.hpp"

namespace spm::stability {

/// A case of three or six degrees of freedom, as reports see both.
class TriedCase {
 public:
  explicit TriedCase(StabilityCase tried) : tried_(std::move(tried)) {}
  explicit TriedCase(SixdofCase tried) : tried_(std::move(tried)) {}

  [[nodiscard]] const std::string& name() const noexcept;
  [[nodiscard]] const std::string& title() const noexcept;
  [[nodiscard]] int degrees() const noexcept { return three() != nullptr ? 3 : 6; }
  /// Null in six degrees of freedom.
  [[nodiscard]] const StabilityCase* three() const noexcept {
    return std::get_if<StabilityCase>(&tried_);
  }
  /// What share of the flat border the case is about; 0: any.
  [[nodiscard]] double of_border() const noexcept;
  /// A tool that is carried has no loop, and so no border.
  [[nodiscard]] bool has_border() const noexcept;

  /// Makes the bake's tolerance at least this, m.
  void coarsen(double tolerance) noexcept;

  /// Bakes what the contenders need. Returns the reason, in words, if that is not possible;
  /// otherwise an empty string.
  [[nodiscard]] std::string prepare(const std::vector<Contender>& contenders);
  [[nodiscard]] std::string why_not(const Contender& contender) const;

  // Like case_verdict and case_border; call these after `prepare`.
  [[nodiscard]] CaseVerdict verdict(const RunSettings& settings, const Contender& contender,
                                    int max_seeds) const;
  [[nodiscard]] double border(const RunSettings& settings, const Contender& contender, double low,
                              double high, double share, int max_seeds) const;

 private:
  std::variant<StabilityCase, SixdofCase> tried_;
  const SixdofScene* scene_ = nullptr;  ///< in six degrees of freedom
};

/// The whole catalogue: three degrees of freedom, then six.
[[nodiscard]] std::vector<TriedCase> tried_cases();

}  // namespace spm::stability
