// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/external/device_external.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "servo/base/clock.hpp"
#include "servo/devices/external/spm_external.h"
#include "servo/shared/trusted_folder.hpp"

namespace spm::servo {

namespace {

/// Largest difference of an orientation's length from 1.
constexpr double unit_slack = 1e-3;

tl::unexpected<Error> io_error(const std::string& what) {
  return fail(ExitCode::file_or_device, "--device external: " + what);
}

/// When the process says that it wrote a pose, which only figures come of; without a time that can
/// be true, when the loop takes it.
std::int64_t time_of(const spm_external_values& pose, std::int64_t now) noexcept {
  const auto told = static_cast<std::int64_t>(__atomic_load_n(&pose.time_ns, __ATOMIC_RELAXED));
  return told > now - SPM_EXTERNAL_SILENCE_NS && told <= now ? told : now;
}

/// Whether a link points to the memory of a process that still runs.
bool leads_somewhere(const std::string& link) noexcept {
  struct stat status {};
  return ::stat(link.c_str(), &status) == 0;
}

}  // namespace

DeviceExternal::DeviceExternal(const ExternalOptions& options)
    : options_(options), capabilities_(capabilities_of("external", *options.profile)) {
  capabilities_.guarded = true;
  // Assumed: its process looks for a wrench once a millisecond.
  capabilities_.own_delay = 0.5e-3;
  capabilities_.buttons = 32;  // a bit each; which of them there are only its process knows
  capabilities_.turns = options.turns;
  capabilities_.torque_cap = options.torque_cap;
  capabilities_.turn_step = options.turns ? options.profile->turn_step() : 0;
  capabilities_.turning_inertia = options.profile->turning_inertia();
}

DeviceExternal::~DeviceExternal() {
  if (!link_.empty()) ::unlink(link_.c_str());
  if (memory_ != nullptr) ::munmap(memory_, sizeof(spm_external_memory));
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> DeviceExternal::open(const DeviceSetup&) {
  descriptor_ = ::memfd_create("spm-external", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  // A process that could shrink the memory could end the loop.
  const bool made =
      descriptor_ >= 0 && ::ftruncate(descriptor_, sizeof(spm_external_memory)) == 0 &&
      ::fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0;
  void* memory = made ? ::mmap(nullptr, sizeof(spm_external_memory), PROT_READ | PROT_WRITE,
                               MAP_SHARED | MAP_POPULATE, descriptor_, 0)
                      : MAP_FAILED;
  if (memory == MAP_FAILED) {
    return io_error(std::string("no memory to share is to be had: ") + std::strerror(errno) +
                    "; free some, or mount /dev/shm");
  }
  memory_ = static_cast<spm_external_memory*>(memory);
  memory_->version = SPM_EXTERNAL_VERSION;
  memory_->bytes = sizeof(spm_external_memory);
  memory_->magic = SPM_EXTERNAL_MAGIC;
  return make_link();
}

Result<void> DeviceExternal::make_link() {
  std::array<char, 512> path{};
  if (spm_external_path(options_.name.c_str(), path.data(), path.size()) == 0) {
    return io_error("the name '" + options_.name +
                    "' is too long, or there is no folder for it; take a shorter one, or set "
                    "XDG_RUNTIME_DIR to a folder of yours with mode 700");
  }
  const std::filesystem::path link = path.data();
  std::error_code problem;
  std::filesystem::create_directories(link.parent_path().parent_path(), problem);
  // So that only the user's own processes find it.
  const bool made = ::mkdir(link.parent_path().c_str(), S_IRWXU) == 0 || errno == EEXIST;
  struct stat folder {};
  if (!made || ::lstat(link.parent_path().c_str(), &folder) != 0 || !S_ISDIR(folder.st_mode) ||
      folder.st_uid != ::geteuid()) {
    return io_error(link.parent_path().string() +
                    ": is no folder of this user; set XDG_RUNTIME_DIR to one");
  }
  if (const std::string fault = distrust_of(link.parent_path()); !fault.empty()) {
    return io_error(fault + ", by XDG_RUNTIME_DIR");
  }
  if (leads_somewhere(link)) {
    return io_error("the name '" + options_.name +
                    "' is in use by another spm-servo; end that one, or take another name");
  }
  ::unlink(link.c_str());
  const std::string target =
      "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(descriptor_);
  if (::symlink(target.c_str(), link.c_str()) != 0) {
    return io_error(link.string() + ": cannot be made: " + std::strerror(errno) +
                    "; check the folder's permissions");
  }
  link_ = link.string();
  return {};
}

DeviceHealth DeviceExternal::read(DeviceState& state) noexcept {
  std::uint32_t buttons = 0;
  std::uint64_t counter = 0;
  std::array<double, 7> numbers{};
  const std::int64_t now = now_ns();
  const bool got = spm_external_get(&memory_->pose, &buttons, &counter, numbers.data()) != 0;
  if (got && counter != last_counter_) {
    const Eigen::Quaterniond turn(numbers[3], numbers[4], numbers[5], numbers[6]);
    const Vector3 position(numbers[0], numbers[1], numbers[2]);
    if (!position.allFinite() || !(std::abs(turn.norm() - 1) <= unit_slack)) {
      return DeviceHealth::fault;
    }
    last_ = {position, turn.normalized(), buttons};
    last_counter_ = counter;
    last_ns_ = now;
    put_ns_ = time_of(memory_->pose, now);
    // The first may have lain there since before the loop began.
    if (attached_) report_age_.add(now - put_ns_);
    fresh_ = attached_;
    attached_ = true;
  }
  if (attached_) {
    ++delays_.readings;
    delays_.age_ns += static_cast<std::uint64_t>(now - last_ns_);
  }
  state = last_;
  const bool is_alive = attached_ && now - last_ns_ <= SPM_EXTERNAL_SILENCE_NS;
  return is_alive ? DeviceHealth::ok : DeviceHealth::silent;
}

DeviceHealth DeviceExternal::write(const Wrench& wrench) noexcept {
  const std::array<double, 7> numbers{wrench.force.x(),
                                      wrench.force.y(),
                                      wrench.force.z(),
                                      wrench.torque.x(),
                                      wrench.torque.y(),
                                      wrench.torque.z(),
                                      0};
  spm_external_put(&memory_->wrench, 0, numbers.data());
  if (fresh_) report_to_command_.add(now_ns() - put_ns_);
  fresh_ = false;
  return DeviceHealth::ok;
}

nlohmann::ordered_json DeviceExternal::describe() const {
  return {{"external_name", options_.name},
          {"profile", options_.profile->name},
          {"turns", options_.turns},
          {"torque_cap_nm", options_.torque_cap},
          {"memory", link_},
          {"attached", attached_},
          {"latency_us",
           {{"report_age", report_age_.json_us()},
            {"report_to_command", report_to_command_.json_us()}}}};
}

}  // namespace spm::servo
