// SPDX-License-Identifier: Apache-2.0
#include "servo/view/view_wishes.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/files/json_text.hpp"

namespace spm::servo {

using nlohmann::json;

namespace {

constexpr double most_exact = 9007199254740992;  // 2^53, up to which a page knows whole numbers
constexpr double most_devices = 64;
constexpr double unit_slack = 1e-3;

/// Reads the fields of a message; `fine` becomes false where one is not as it must be.
class Fields {
 public:
  explicit Fields(const json& message) : message_(message) {}

  double number(const char* name) {
    const auto found = message_.find(name);
    if (found == message_.end()) return fail();
    return of(*found);
  }
  std::uint64_t whole(const char* name, double most) {
    const double value = number(name);
    if (!(value >= 0 && value <= most && value == std::floor(value))) return fine_ = false, 0;
    return static_cast<std::uint64_t>(value);
  }
  std::uint32_t device() { return static_cast<std::uint32_t>(whole("device", most_devices)); }
  template <std::size_t Count>
  std::array<double, Count> numbers(const char* name) {
    std::array<double, Count> values{};
    const auto found = message_.find(name);
    if (found == message_.end() || !found->is_array() || found->size() != Count) {
      fine_ = false;
      return values;
    }
    for (std::size_t i = 0; i < Count; ++i) values[i] = of((*found)[i]);
    return values;
  }
  [[nodiscard]] bool has(const char* name) const { return message_.contains(name); }
  void hold(bool fine) noexcept { fine_ = fine_ && fine; }
  [[nodiscard]] bool fine() const noexcept { return fine_; }

 private:
  double fail() noexcept {
    fine_ = false;
    return 0;
  }
  double of(const json& value) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) return fail();
    return value.get<double>();
  }

  const json& message_;
  bool fine_ = true;
};

LeadWish read_lead(Fields& fields) {
  LeadWish wish;
  wish.device = fields.device();
  const auto place = fields.numbers<3>("p");
  const auto turn = fields.numbers<4>("q");
  wish.hand.position = {place[0], place[1], place[2]};
  wish.hand.orientation = Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]);
  fields.hold(std::abs(wish.hand.orientation.norm() - 1) < unit_slack);
  wish.number = fields.number("n");
  return wish;
}

FeelWish read_feel(Fields& fields) {
  FeelWish wish;
  wish.object = fields.whole("object", most_exact);
  if (fields.has("stiffness")) wish.feel.stiffness = fields.number("stiffness");
  if (fields.has("friction")) wish.feel.friction = fields.numbers<2>("friction");
  if (fields.has("damping")) wish.feel.damping = fields.number("damping");
  if (fields.has("texture")) wish.feel.texture = fields.numbers<2>("texture");
  return wish;
}

MethodWish read_method(Fields& fields) {
  MethodWish wish;
  wish.object = fields.whole("object", most_exact);
  wish.method = static_cast<std::uint32_t>(fields.whole("method", SPM_CLIENT_METHOD_PROXY));
  return wish;
}

}  // namespace

std::optional<ViewWish> read_wish(const std::string& text) {
  const json message = parse_json<json>(text);
  if (!message.is_object() || !message.contains("t") || !message["t"].is_string()) return {};
  const auto kind = message["t"].get<std::string>();
  Fields fields(message);
  std::optional<ViewWish> wish;
  if (kind == "hand") {
    wish = read_lead(fields);
  } else if (kind == "free") {
    wish = FreeWish{fields.device()};
  } else if (kind == "feel") {
    wish = read_feel(fields);
  } else if (kind == "method") {
    wish = read_method(fields);
  } else if (kind == "stabilize") {
    wish = StabilizeWish{fields.whole("on", 1) != 0};
  } else if (kind == "cap") {
    const std::uint32_t device = fields.device();
    wish = CapWish{device, fields.number("newtons")};
  } else if (kind == "acknowledge") {
    wish = AcknowledgeWish{fields.device()};
  } else if (kind == "seen") {
    wish = SeenWish{};
  }
  return fields.fine() ? wish : std::nullopt;
}

}  // namespace spm::servo
