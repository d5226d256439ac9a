// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/hand_pose.hpp"
#include "servo/view/view_state.hpp"

namespace spm::servo {

/// How long a hand is led without a next command: as long as an application may hold it, since a
/// page that draws in software on a busy machine pauses for most of it.
inline constexpr std::chrono::milliseconds hand_hold{1000};

/// Which daemon is watched.
struct FeedSettings {
  std::string socket, name;       ///< as libspm_client takes them; empty: the usual ones
  std::uint32_t server_user = 0;  ///< whose daemon is trusted as well
};

/// A page's wishes for an object; what it does not give stays.
struct WishedFeel {
  std::optional<double> stiffness;                ///< N/m
  std::optional<std::array<double, 2>> friction;  ///< stick, slide
  std::optional<double> damping;                  ///< N s/m
  std::optional<std::array<double, 2>> texture;   ///< amplitude and wavelength, m
};

/// Watches a daemon as one of its applications, finds it again when it was restarted, and sends it
/// what pages wish. Belongs to one thread; none of its calls waits for the loop.
class ViewFeed {
 public:
  explicit ViewFeed(FeedSettings settings);
  ViewFeed(const ViewFeed&) = delete;
  ViewFeed& operator=(const ViewFeed&) = delete;
  ~ViewFeed();

  /// Reads the newest tick; call it for each frame. Looks for a daemon twice a second where there
  /// is none.
  void look();
  [[nodiscard]] const ViewState& state() const noexcept { return state_; }
  /// The newest frame, and the scene's text, whose number rises when it changes.
  [[nodiscard]] const std::vector<double>& frame() const noexcept { return frame_; }
  [[nodiscard]] const std::string& scene() const noexcept { return scene_; }
  [[nodiscard]] std::uint64_t scene_number() const noexcept { return scene_number_; }
  /// The mesh of an asset, as to_bytes() gives it; null where there is none yet.
  [[nodiscard]] std::shared_ptr<const std::string> mesh(std::size_t asset) const noexcept;

  /// What pages wish. Each returns a sentence where it cannot be sent, else an empty text.
  [[nodiscard]] std::string lead(std::uint32_t device, const HandPose& hand);
  [[nodiscard]] std::string let_go(std::uint32_t device);
  [[nodiscard]] std::string feel(std::uint64_t object, const WishedFeel& wished);
  /// `method` is one of enum spm_client_method.
  [[nodiscard]] std::string choose_method(std::uint64_t object, std::uint32_t method);
  [[nodiscard]] std::string stabilize(bool on);
  [[nodiscard]] std::string cap(std::uint32_t device, double newtons);
  [[nodiscard]] std::string acknowledge(std::uint32_t device);
  /// Why the loop refused the last command; empty where it refused none since the last call.
  [[nodiscard]] std::string refusal();

 private:
  using Clock = std::chrono::steady_clock;
  struct Mesh {
    std::string path, stamp, error;
    std::shared_ptr<const std::string> bytes;
    double cell = 0;
    std::uint64_t number = 0, triangles = 0;
  };
  struct Disconnect {
    void operator()(spm_client* client) const noexcept { spm_client_disconnect(client); }
  };

  void connect();
  void drop(int daemon);
  void read_names();
  void read_tick();
  void read_feels();
  void load_meshes();
  void tell_scene();
  [[nodiscard]] static Mesh load(const std::string& path, const std::string& stamp);
  [[nodiscard]] std::string sent(int code) const;

  FeedSettings settings_;
  std::unique_ptr<spm_client, Disconnect> client_;
  ViewState state_;
  spm_client_loop before_{};
  std::vector<double> frame_;
  std::string scene_;
  std::uint64_t scene_number_ = 0, meshes_made_ = 0, refused_ = 0;
  Clock::time_point connect_again_, names_again_;
  std::vector<Mesh> meshes_;
  std::future<Mesh> loading_;
};

}  // namespace spm::servo
