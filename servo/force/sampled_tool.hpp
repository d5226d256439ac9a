// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/sixdof/object_contact.hpp"
#include "common/sixdof/surface_samples.hpp"
#include "servo/force/tool_culling.hpp"
#include "servo/force/tool_settings.hpp"

namespace spm {

/// A tool's surface as nested samples, and for each hand that holds it the memory of its contact
/// with the objects. Made by the loading thread, which alone may allocate; then used by the loop.
class SampledTool {
 public:
  /// `asset`: the tool's, `sparse`, or `full` for method `paper`; what it views must be valid as
  /// long as the result. `objects`: the largest number that
  /// the scene can have. Errors: invalid_input, with a sentence that begins with its cause, where
  /// the asset has no inside or no surface to sample, or the spacing gives too many samples.
  [[nodiscard]] static Result<std::unique_ptr<SampledTool>> make(const AssetView& asset,
                                                                 const ToolSettings& settings,
                                                                 std::size_t hands,
                                                                 std::size_t objects);

  [[nodiscard]] const SurfaceSamples& samples() const noexcept { return samples_; }
  /// The tool's asset where it is a `full` one, for method `paper`; then there are no samples.
  [[nodiscard]] const AssetView* paper() const noexcept { return paper_ ? &*paper_ : nullptr; }
  /// Of one hand.
  [[nodiscard]] ObjectContact& contact(std::size_t hand) noexcept { return contacts_[hand]; }
  [[nodiscard]] ToolCulling& culling(std::size_t hand) noexcept { return cullings_[hand]; }
  /// m of the world: certified error of its surface.
  [[nodiscard]] double error() const noexcept { return error_; }
  /// m: clusters of samples that are closer than this are one patch.
  [[nodiscard]] double patch_size() const noexcept;
  /// That answers may come from, of all hands.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  SampledTool() = default;

  SurfaceSamples samples_;
  double error_ = 0;
  std::optional<AssetView> paper_;
  std::vector<ObjectContact> contacts_;
  SupportHull hull_;
  std::vector<ToolCulling> cullings_;
};

}  // namespace spm
