// SPDX-License-Identifier: Apache-2.0
#include "servo/doctor/doctor_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace spm::servo {

namespace {

constexpr const char* best_governor = "performance";

Check unknown(const char* name, const char* measured) {
  return {name, Verdict::unknown, measured, ""};
}

}  // namespace

Check judge_kernel(const MachineFacts& facts) {
  if (facts.kernel_release.empty())
    return unknown("kernel", "the kernel's release is not readable");
  const std::string measured =
      fmt::format("Linux {} {}", facts.kernel_release, facts.kernel_version);
  if (facts.realtime_kernel)
    return {"kernel", Verdict::good, measured + ", a real-time kernel", ""};
  return {"kernel", Verdict::fair, measured + ", not a real-time kernel",
          "Where wake-ups are late, boot a real-time kernel (Debian: apt-get install "
          "linux-image-rt-amd64)."};
}

Check judge_virtual(const MachineFacts& facts) {
  if (!facts.is_virtual) return unknown("virtual", "the processor does not tell");
  if (!*facts.is_virtual) return {"virtual", Verdict::good, "not a virtual machine", ""};
  return {"virtual", Verdict::fair, "a virtual machine, whose host can stop it for milliseconds",
          "Run the servo on the host itself, or give this machine processors of its own."};
}

Check judge_governor(const MachineFacts& facts) {
  if (facts.governors.empty()) return unknown("governor", "no frequency control is to be seen");
  std::map<std::string, int> counts;
  for (const std::string& governor : facts.governors) ++counts[governor];
  std::string measured;
  for (const auto& [governor, count] : counts) {
    measured += fmt::format("{}{} on {} processor{}", measured.empty() ? "" : ", ", governor, count,
                            count == 1 ? "" : "s");
  }
  if (counts.size() == 1 && counts.begin()->first == best_governor) {
    return {"governor", Verdict::good, measured, ""};
  }
  return {"governor", Verdict::fair, measured,
          "Run: echo performance | sudo tee "
          "/sys/devices/system/cpu/cpu*/cpufreq/scaling_governor (until the next boot)."};
}

Check judge_idle(const MachineFacts& facts) {
  if (!facts.idle_exit_us) return unknown("idle_states", "no idle states are to be seen");
  const std::string measured = fmt::format("the slowest in use, {}, is left within {:.0f} us",
                                           facts.idle_state, *facts.idle_exit_us);
  if (*facts.idle_exit_us <= good_idle_exit_us) return {"idle_states", Verdict::good, measured, ""};
  if (facts.may_hold_latency) {
    return {"idle_states", Verdict::good, measured + "; 'spm-servo run' holds it off", ""};
  }
  return {"idle_states", Verdict::fair, measured,
          fmt::format("Run: sudo cpupower idle-set -D {:.0f} (until the next boot); or allow "
                      "/dev/cpu_dma_latency, see cpu_latency.",
                      good_idle_exit_us)};
}

Check judge_latency(const MachineFacts& facts) {
  if (!facts.has_latency) return unknown("cpu_latency", "there is no /dev/cpu_dma_latency");
  if (facts.may_hold_latency) {
    return {"cpu_latency", Verdict::good,
            "'spm-servo run' holds /dev/cpu_dma_latency, so that no core sleeps deeply", ""};
  }
  return {"cpu_latency", Verdict::fair,
          "this user may not write /dev/cpu_dma_latency, so that cores may sleep deeply",
          "Write the line KERNEL==\"cpu_dma_latency\", GROUP=\"spm-haptics\", MODE=\"0660\" to a "
          "file in /etc/udev/rules.d, join that group, and boot again."};
}

Check judge_interrupts(const MachineFacts& facts) {
  if (facts.usb_interrupts.empty()) {
    return unknown("usb_interrupts", "no interrupt of a USB controller is to be seen");
  }
  std::vector<std::size_t> free = cores_of_list(facts.online_list);
  std::string measured;
  for (const UsbInterrupt& interrupt : facts.usb_interrupts) {
    measured += fmt::format("{}interrupt {} ({}) comes on {}", measured.empty() ? "" : ", ",
                            interrupt.number, interrupt.name,
                            interrupt.cores.empty() ? "cores not readable" : interrupt.cores);
    const std::vector<std::size_t> taken = cores_of_list(interrupt.cores);
    if (taken.empty()) return unknown("usb_interrupts", measured.c_str());
    std::erase_if(free, [&taken](std::size_t core) {
      return std::find(taken.begin(), taken.end(), core) != taken.end();
    });
  }
  if (!free.empty()) {
    return {"usb_interrupts", Verdict::good,
            measured + fmt::format("; 'spm-servo run --core {}' keeps the loop off", free.back()),
            ""};
  }
  if (facts.online < 2) return {"usb_interrupts", Verdict::fair, measured, ""};
  return {
      "usb_interrupts", Verdict::fair, measured + ", on any core that the loop may run on",
      fmt::format("Run: echo {} | sudo tee /proc/irq/{}/smp_affinity_list (until the next boot; "
                  "irqbalance must leave it alone), and give the loop another core: 'spm-servo "
                  "run --core {}'.",
                  cores_of_list(facts.online_list).front(), facts.usb_interrupts.front().number,
                  cores_of_list(facts.online_list).back())};
}

Check judge_processors(const MachineFacts& facts) {
  if (facts.online == 0) return unknown("processors", "their number is not readable");
  std::string measured =
      fmt::format("{} online, {}", facts.online,
                  facts.isolated.empty() ? "none isolated" : "isolated: " + facts.isolated);
  if (facts.load) measured += fmt::format(", load average {:.2f}", *facts.load);
  if (facts.online >= 2) return {"processors", Verdict::good, measured, ""};
  return {"processors", Verdict::fair, measured,
          "With one processor the loop takes its time from the application; use a machine with two "
          "or more."};
}

Check judge_throttling(const MachineFacts& facts) {
  if (!facts.rt_runtime_us || !facts.rt_period_us || *facts.rt_period_us <= 0) {
    return unknown("throttling", "the kernel's limit for real-time threads is not readable");
  }
  if (*facts.rt_runtime_us < 0) {
    return {"throttling", Verdict::good, "real-time threads are without limit", ""};
  }
  const double share =
      static_cast<double>(*facts.rt_runtime_us) / static_cast<double>(*facts.rt_period_us);
  const std::string measured =
      fmt::format("real-time threads may use {:.0f} % of the time", 100 * share);
  // The loop and the threads of its devices need far less than half of a processor.
  if (share >= 0.5) return {"throttling", Verdict::good, measured, ""};
  return {"throttling", share > 0 ? Verdict::fair : Verdict::poor, measured,
          "Run: sudo sysctl kernel.sched_rt_runtime_us=950000 (the kernel's default)."};
}

Check judge_cgroup(const MachineFacts& facts) {
  if (!facts.has_cgroup) return unknown("control_group", "no unified control group is mounted");
  if (!facts.quota) {
    return {"control_group", Verdict::good, "no limit on the processor time", ""};
  }
  return {"control_group", facts.quota->processors < 1 ? Verdict::poor : Verdict::fair,
          fmt::format("{} may use {:.2g} processors", facts.quota->group, facts.quota->processors),
          "Raise or remove the limit (CPUQuota= of the unit, --cpus of the container): a thread "
          "that used up its share sleeps until the next period."};
}

}  // namespace spm::servo
