// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "common/base/hand_pose.hpp"
#include "servo/view/view_feed.hpp"

namespace spm::servo {

/// Messages of a page. Devices and objects are named as the frame names them.
struct LeadWish {
  std::uint32_t device = 0;
  HandPose hand;      ///< finite; the orientation unit
  double number = 0;  ///< of the page's own, which its frames give back
};
struct FreeWish {
  std::uint32_t device = 0;
};
struct FeelWish {
  std::uint64_t object = 0;
  WishedFeel feel;
};
struct MethodWish {
  std::uint64_t object = 0;
  std::uint32_t method = 0;  ///< enum spm_client_method
};
struct StabilizeWish {
  bool on = false;
};
struct CapWish {
  std::uint32_t device = 0;
  double newtons = 0;
};
struct AcknowledgeWish {
  std::uint32_t device = 0;
};
/// A frame was seen.
struct SeenWish {};
using ViewWish = std::variant<LeadWish, FreeWish, FeelWish, MethodWish, StabilizeWish, CapWish,
                              AcknowledgeWish, SeenWish>;

/// Reads a page's message, JSON such as {"t":"hand","device":0,"p":[0,0,0],"q":[1,0,0,0],"n":5}.
/// Nothing where it is no such message, or has a number that is missing or not finite.
[[nodiscard]] std::optional<ViewWish> read_wish(const std::string& text);

}  // namespace spm::servo
