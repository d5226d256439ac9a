// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace spm::servo {

/// The processor time that a control group may use in each period.
struct CpuQuota {
  std::string group;      ///< path of the group that sets it
  double processors = 0;  ///< quota divided by period
};

/// An interrupt of a USB controller.
struct UsbInterrupt {
  unsigned number = 0;
  std::string name;   ///< of its driver ("xhci_hcd")
  std::string cores;  ///< list of those on which it may come ("0-3"); empty: not readable
};

/// What the kernel reports about this machine in /proc and /sys. Values that could not be read are
/// empty.
struct MachineFacts {
  std::vector<std::string> governors;  ///< one for each processor that has frequency control
  std::optional<bool> is_virtual;  ///< whether the processor reports a hypervisor; only x86 does
  std::size_t online = 0;          ///< processors
  std::string online_list;         ///< which ("0-3")
  std::string isolated;        ///< list of the processors that are kept free of other work ("2-3")
  std::string kernel_release;  ///< "6.1.0-56-amd64"
  std::string kernel_version;  ///< "#1 SMP PREEMPT_DYNAMIC ..."
  bool realtime_kernel = false;               ///< PREEMPT_RT
  std::optional<std::int64_t> rt_runtime_us;  ///< of each period; -1 is without limit
  std::optional<std::int64_t> rt_period_us;
  bool has_cgroup = false;  ///< a unified control group is mounted
  /// the tightest limit that holds for this process; empty: no limit
  std::optional<CpuQuota> quota;
  std::string idle_state;              ///< the slowest one in use on the first processor ("C10")
  std::optional<double> idle_exit_us;  ///< time to leave it
  bool has_latency = false;            ///< there is a /dev/cpu_dma_latency
  bool may_hold_latency = false;       ///< this user may write it
  std::vector<UsbInterrupt> usb_interrupts;
  std::optional<double> load;  ///< runnable tasks, mean of the last minute
};

/// Reads the facts. `root` is put before /proc, /sys and /dev.
[[nodiscard]] MachineFacts read_machine(const std::string& root = "");

/// The processors in a kernel's list such as "0-3,8"; empty if the list is invalid.
[[nodiscard]] std::vector<std::size_t> cores_of_list(const std::string& list);

/// Number of processors in a kernel's list such as "0-3,8"; 0 if the list is invalid.
[[nodiscard]] std::size_t count_of_list(const std::string& list);

}  // namespace spm::servo
