// SPDX-License-Identifier: Apache-2.0
#include "servo/doctor/doctor.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "servo/doctor/doctor_limits.hpp"
#include "servo/doctor/doctor_machine.hpp"
#include "servo/doctor/doctor_usb.hpp"
#include "tests/servo/support/shape_asset.hpp"

namespace doctor_test {

using namespace spm::servo;
using spm::test::TemporaryFolder;

namespace {

/// A machine's /proc, /sys and /dev, written by hand.
class Machine {
 public:
  void put(const std::string& path, const std::string& text) const {
    const std::filesystem::path file = folder_.path() + path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  [[nodiscard]] MachineFacts facts() const { return read_machine(folder_.path()); }

 private:
  TemporaryFolder folder_;
};

/// Wake-ups: the first `late` of them are late by `late_us`, the others by 20 us.
Wakeups wakeups_of(int ticks, int late, double late_us) {
  Wakeups wakeups;
  DurationHistogram histogram;
  for (int i = 0; i < ticks; ++i) {
    const auto lateness = static_cast<std::int64_t>(1e3 * (i < late ? late_us : 20));
    wakeups.count(lateness);
    histogram.add(lateness);
  }
  wakeups.us = histogram.summary_us();
  return wakeups;
}

RealtimeState granted() {
  RealtimeState state;
  state.policy = "fifo";
  state.priority = 80;
  state.memory_locked = true;
  return state;
}

}  // namespace

TEST_CASE("Wake-ups are good within 250 us, fair within 500 us, and not good if one lost a tick") {
  REQUIRE(judge_wakeups(wakeups_of(10000, 0, 0)).verdict == Verdict::good);
  REQUIRE(judge_wakeups(wakeups_of(10000, 100, 240)).verdict == Verdict::good);
  REQUIRE(judge_wakeups(wakeups_of(10000, 10, 900)).verdict == Verdict::good);
  REQUIRE(judge_wakeups(wakeups_of(10000, 1, 1000)).verdict == Verdict::fair);
  REQUIRE(judge_wakeups(wakeups_of(10000, 11, 260)).verdict == Verdict::fair);
  REQUIRE(judge_wakeups(wakeups_of(10000, 11, 510)).verdict == Verdict::poor);
  REQUIRE(judge_wakeups(wakeups_of(10000, 5000, 8000)).verdict == Verdict::poor);
  REQUIRE(judge_wakeups(Wakeups{}).verdict == Verdict::unknown);
}

TEST_CASE("Late wake-ups are counted from each bound on") {
  Wakeups wakeups;
  for (const std::int64_t late_us : {0, 199, 200, 499, 500, 999, 1000, 5000}) {
    wakeups.count(late_us * 1000);
  }
  REQUIRE(wakeups.ticks == 8);
  REQUIRE(wakeups.late_200us == 6);
  REQUIRE(wakeups.late_500us == 4);
  REQUIRE(wakeups.late_1ms == 2);
}

TEST_CASE("A machine is at best fair without real-time priority, however well it woke up") {
  REQUIRE(overall_verdict(Verdict::good, Verdict::good) == Verdict::good);
  REQUIRE(overall_verdict(Verdict::good, Verdict::poor) == Verdict::fair);
  REQUIRE(overall_verdict(Verdict::fair, Verdict::good) == Verdict::fair);
  REQUIRE(overall_verdict(Verdict::poor, Verdict::good) == Verdict::poor);
  REQUIRE(overall_verdict(Verdict::poor, Verdict::poor) == Verdict::poor);
  REQUIRE(overall_verdict(Verdict::unknown, Verdict::good) == Verdict::unknown);
}

TEST_CASE("A measurement counts what it woke up for, and tells its progress") {
  double last = -1;
  bool rising = true;
  const Wakeups wakeups = measure_wakeups(0.3, [&](double share) {
    rising = rising && share >= last && share <= 1;
    last = share;
  });
  REQUIRE(wakeups.ticks > 0);
  // Every tick of the grid was woken up for or skipped; the last may have overrun the end.
  REQUIRE(wakeups.ticks + wakeups.skipped >= 300);
  REQUIRE(wakeups.us.p50 <= wakeups.us.p99);
  REQUIRE(wakeups.us.p999 <= wakeups.us.max);
  REQUIRE(wakeups.late_1ms <= wakeups.late_500us);
  REQUIRE(wakeups.late_500us <= wakeups.late_200us);
  REQUIRE(rising);
  REQUIRE(last >= 0);
}

TEST_CASE("Refused priority is poor, and its cure depends on who refused it") {
  REQUIRE(judge_scheduling(granted(), {false, 90, 0}).verdict == Verdict::good);
  const Check limited = judge_scheduling({}, {false, 0, 0});
  REQUIRE(limited.verdict == Verdict::poor);
  REQUIRE(limited.measured.find("rtprio 0") != std::string::npos);
  REQUIRE(limited.cure.find("limits.d") != std::string::npos);
  for (const ProcessLimits& limits : {ProcessLimits{true, 0, 0}, ProcessLimits{false, 90, 0},
                                      ProcessLimits{false, std::nullopt, 0}}) {
    const Check contained = judge_scheduling({}, limits);
    REQUIRE(contained.verdict == Verdict::poor);
    REQUIRE(contained.cure.find("CAP_SYS_NICE") != std::string::npos);
  }
}

TEST_CASE("Memory that is locked under a limit is fair only, since later memory is not") {
  REQUIRE(judge_memory_lock(granted(), {true, 0, 8192}).verdict == Verdict::good);
  REQUIRE(judge_memory_lock(granted(), {false, 0, std::nullopt}).verdict == Verdict::good);
  const Check limited = judge_memory_lock(granted(), {false, 0, 64 << 20});
  REQUIRE(limited.verdict == Verdict::fair);
  REQUIRE(limited.measured.find("65536 KiB") != std::string::npos);
  REQUIRE(judge_memory_lock({}, {false, 0, 8192}).verdict == Verdict::poor);
}

TEST_CASE("A process with the capabilities needs no limits and no root, and is told so") {
  const ProcessLimits capable{false, 0, 8192, true, true};
  const Check scheduling = judge_scheduling(granted(), capable);
  CHECK(scheduling.verdict == Verdict::good);
  CHECK(scheduling.measured.find("CAP_SYS_NICE, so without limit") != std::string::npos);
  CHECK(judge_memory_lock(granted(), capable).verdict == Verdict::good);
  for (const Check& check :
       {judge_scheduling({}, {false, 0, 0}), judge_memory_lock({}, {false, 0, 0})}) {
    CHECK(check.cure.find("CAP_SYS_NICE CAP_IPC_LOCK") != std::string::npos);
    CHECK(check.cure.find("Root is not needed") != std::string::npos);
  }
}

TEST_CASE("A machine of which nothing can be read is unknown in everything, and no failure") {
  const MachineFacts facts = Machine().facts();
  for (const Check& check :
       {judge_kernel(facts), judge_virtual(facts), judge_governor(facts), judge_idle(facts),
        judge_processors(facts), judge_throttling(facts), judge_cgroup(facts)}) {
    CAPTURE(check.name);
    REQUIRE(check.verdict == Verdict::unknown);
    REQUIRE_FALSE(check.measured.empty());
  }
}

TEST_CASE("Files with garbage are read as if they were not there") {
  const Machine machine;
  const std::string garbage("\x00\xff,-,\n9999999999999999999999999", 30);
  for (const char* path :
       {"/proc/cpuinfo", "/proc/loadavg", "/proc/self/cgroup",
        "/proc/sys/kernel/sched_rt_runtime_us", "/proc/sys/kernel/sched_rt_period_us",
        "/sys/kernel/realtime", "/sys/devices/system/cpu/online",
        "/sys/devices/system/cpu/cpu0/cpuidle/state0/latency", "/sys/fs/cgroup/cpu.max",
        "/sys/fs/cgroup/cgroup.controllers"}) {
    machine.put(path, garbage);
  }
  const MachineFacts facts = machine.facts();
  REQUIRE_FALSE(facts.is_virtual);
  REQUIRE_FALSE(facts.rt_runtime_us);
  REQUIRE_FALSE(facts.idle_exit_us);
  REQUIRE_FALSE(facts.has_cgroup);
  REQUIRE(facts.online == 0);
}

TEST_CASE("A real-time kernel is told by its own file or by its version") {
  Machine machine;
  machine.put("/proc/sys/kernel/osrelease", "6.1.0-56-amd64\n");
  machine.put("/proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.1\n");
  REQUIRE(judge_kernel(machine.facts()).verdict == Verdict::fair);
  REQUIRE(judge_kernel(machine.facts()).measured.find("6.1.0-56-amd64") != std::string::npos);
  machine.put("/sys/kernel/realtime", "1\n");
  REQUIRE(judge_kernel(machine.facts()).verdict == Verdict::good);
  machine.put("/sys/kernel/realtime", "0\n");
  machine.put("/proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian 6.1\n");
  REQUIRE(judge_kernel(machine.facts()).verdict == Verdict::good);
}

TEST_CASE("A virtual machine is told by its processor's flags") {
  const Machine machine;
  machine.put("/proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu vme hypervisor sse\n");
  REQUIRE(judge_virtual(machine.facts()).verdict == Verdict::fair);
  machine.put("/proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu vme sse hypervisor_not\n");
  REQUIRE(judge_virtual(machine.facts()).verdict == Verdict::good);
  machine.put("/proc/cpuinfo", "processor\t: 0\nFeatures\t: fp asimd\n");
  REQUIRE(judge_virtual(machine.facts()).verdict == Verdict::unknown);
}

TEST_CASE("Governors are good only where every processor has the same best one") {
  const Machine machine;
  const std::string folder = "/sys/devices/system/cpu/";
  machine.put(folder + "cpu0/cpufreq/scaling_governor", "performance\n");
  machine.put(folder + "cpu10/cpufreq/scaling_governor", "performance\n");
  machine.put(folder + "cpufreq/scaling_governor", "none of a processor\n");
  REQUIRE(machine.facts().governors.size() == 2);
  REQUIRE(judge_governor(machine.facts()).verdict == Verdict::good);
  machine.put(folder + "cpu2/cpufreq/scaling_governor", "powersave\n");
  const Check mixed = judge_governor(machine.facts());
  REQUIRE(mixed.verdict == Verdict::fair);
  REQUIRE(mixed.measured == "performance on 2 processors, powersave on 1 processor");
  REQUIRE(mixed.cure.find("performance") != std::string::npos);
}

TEST_CASE("The slowest idle state that is in use counts, not one that is switched off") {
  const Machine machine;
  const std::string state = "/sys/devices/system/cpu/cpu0/cpuidle/state";
  machine.put(state + "0/latency", "0\n");
  machine.put(state + "0/name", "POLL\n");
  machine.put(state + "1/latency", "2\n");
  machine.put(state + "1/name", "C1\n");
  machine.put(state + "2/latency", "890\n");
  machine.put(state + "2/name", "C10\n");
  const Check deep = judge_idle(machine.facts());
  REQUIRE(deep.verdict == Verdict::fair);
  REQUIRE(deep.measured.find("C10") != std::string::npos);
  machine.put(state + "2/disable", "1\n");
  const Check shallow = judge_idle(machine.facts());
  REQUIRE(shallow.verdict == Verdict::good);
  REQUIRE(shallow.measured.find("C1,") != std::string::npos);
}

TEST_CASE("Idle states are no trouble where the loop may hold them off") {
  const Machine machine;
  const std::string state = "/sys/devices/system/cpu/cpu0/cpuidle/state0";
  machine.put(state + "/latency", "900\n");
  machine.put(state + "/name", "C10\n");
  REQUIRE(judge_latency(machine.facts()).verdict == Verdict::unknown);
  machine.put("/dev/cpu_dma_latency", "");
  REQUIRE(judge_latency(machine.facts()).verdict == Verdict::good);
  REQUIRE(judge_idle(machine.facts()).verdict == Verdict::good);
  MachineFacts facts = machine.facts();
  facts.may_hold_latency = false;  // root may write anything
  REQUIRE(judge_latency(facts).verdict == Verdict::fair);
  REQUIRE(judge_latency(facts).cure.find("/etc/udev/rules.d") != std::string::npos);
  REQUIRE(judge_idle(facts).verdict == Verdict::fair);
}

TEST_CASE("Where USB interrupts come on every core, doctor says how to keep the loop off them") {
  const Machine machine;
  REQUIRE(judge_interrupts(machine.facts()).verdict == Verdict::unknown);
  machine.put("/sys/devices/system/cpu/online", "0-3\n");
  machine.put(
      "/proc/interrupts",
      "           CPU0       CPU1       CPU2       CPU3\n"
      "  1:          9          0          0          0  IO-APIC    1-edge      i8042\n"
      " 24:    1234567          0          0          0  PCI-MSI 327680-edge      xhci_hcd\n"
      "NMI:          0          0          0          0  Non-maskable interrupts\n");
  const Check hidden = judge_interrupts(machine.facts());
  REQUIRE(hidden.verdict == Verdict::unknown);
  machine.put("/proc/irq/24/smp_affinity_list", "0-3\n");
  const Check everywhere = judge_interrupts(machine.facts());
  REQUIRE(everywhere.verdict == Verdict::fair);
  REQUIRE(everywhere.measured.find("interrupt 24 (xhci_hcd) comes on 0-3") == 0);
  REQUIRE(everywhere.cure.find("/proc/irq/24/smp_affinity_list") != std::string::npos);
  REQUIRE(everywhere.cure.find("--core 3") != std::string::npos);
  machine.put("/proc/irq/24/smp_affinity_list", "0,2\n");
  const Check apart = judge_interrupts(machine.facts());
  REQUIRE(apart.verdict == Verdict::good);
  REQUIRE(apart.measured.find("--core 3") != std::string::npos);
}

TEST_CASE("Processors are counted from the kernel's list") {
  REQUIRE(count_of_list("0") == 1);
  REQUIRE(count_of_list("0-3,8,10-11") == 7);
  REQUIRE(count_of_list("") == 0);
  REQUIRE(count_of_list("3-1") == 0);
  REQUIRE(count_of_list("a-b") == 0);
  const Machine machine;
  machine.put("/sys/devices/system/cpu/online", "0-3\n");
  machine.put("/sys/devices/system/cpu/isolated", "3\n");
  machine.put("/proc/loadavg", "1.25 0.90 0.80 2/300 4711\n");
  const Check four = judge_processors(machine.facts());
  REQUIRE(four.verdict == Verdict::good);
  REQUIRE(four.measured == "4 online, isolated: 3, load average 1.25");
  machine.put("/sys/devices/system/cpu/online", "0\n");
  REQUIRE(judge_processors(machine.facts()).verdict == Verdict::fair);
}

TEST_CASE("A kernel that gives real-time threads no time is poor") {
  const Machine machine;
  machine.put("/proc/sys/kernel/sched_rt_period_us", "1000000\n");
  const auto verdict = [&](const char* runtime) {
    machine.put("/proc/sys/kernel/sched_rt_runtime_us", runtime);
    return judge_throttling(machine.facts()).verdict;
  };
  REQUIRE(verdict("950000\n") == Verdict::good);
  REQUIRE(verdict("-1\n") == Verdict::good);
  REQUIRE(verdict("100000\n") == Verdict::fair);
  REQUIRE(verdict("0\n") == Verdict::poor);
}

TEST_CASE("The tightest limit of the control groups above counts") {
  const Machine machine;
  machine.put("/sys/fs/cgroup/cgroup.controllers", "cpu memory\n");
  machine.put("/proc/self/cgroup", "0::/user.slice/user-1000.slice\n");
  REQUIRE(judge_cgroup(machine.facts()).verdict == Verdict::good);
  machine.put("/sys/fs/cgroup/user.slice/user-1000.slice/cpu.max", "max 100000\n");
  REQUIRE(judge_cgroup(machine.facts()).verdict == Verdict::good);
  machine.put("/sys/fs/cgroup/user.slice/cpu.max", "150000 100000\n");
  const Check wide = judge_cgroup(machine.facts());
  REQUIRE(wide.verdict == Verdict::fair);
  REQUIRE(wide.measured.find("/user.slice may use 1.5 processors") != std::string::npos);
  machine.put("/sys/fs/cgroup/user.slice/user-1000.slice/cpu.max", "50000 100000\n");
  REQUIRE(judge_cgroup(machine.facts()).verdict == Verdict::poor);
}

TEST_CASE("A limit of a container's own control group is found at the top of the tree") {
  const Machine machine;
  machine.put("/sys/fs/cgroup/cgroup.controllers", "cpu\n");
  machine.put("/proc/self/cgroup", "0::/\n");
  machine.put("/sys/fs/cgroup/cpu.max", "50000 100000\n");
  REQUIRE(judge_cgroup(machine.facts()).verdict == Verdict::poor);
}

TEST_CASE("A device that may not be opened is poor, one that is not driven counts for nothing") {
  DeviceSearch search;
  REQUIRE(judge_devices(search).verdict == Verdict::unknown);
  FoundDevice serial;
  serial.match = {"woodenhaptics", false, ""};
  search.devices = {serial};
  REQUIRE(judge_devices(search).verdict == Verdict::unknown);
  FoundDevice falcon;
  falcon.match = {"falcon", true, ""};
  falcon.node = "/dev/bus/usb/001/005";
  falcon.access = NodeAccess::granted;
  search.devices.push_back(falcon);
  REQUIRE(judge_devices(search).verdict == Verdict::good);
  falcon.access = NodeAccess::denied;
  search.devices.push_back(falcon);
  const Check check = judge_devices(search);
  REQUIRE(check.verdict == Verdict::poor);
  REQUIRE(check.cure.find("udev") != std::string::npos);
}

TEST_CASE("The slowest device's round trip decides") {
  const auto trip = [](const char* usb, double p50) {
    return RoundTrips{usb, 300, {p50, 0, p50, p50, p50, p50}};
  };
  REQUIRE(judge_round_trips({}).verdict == Verdict::unknown);
  REQUIRE(judge_round_trips({trip("1-1", 300)}).verdict == Verdict::good);
  REQUIRE(judge_round_trips({trip("1-1", 2900), trip("1-2", 300)}).verdict == Verdict::fair);
  const Check slow = judge_round_trips({trip("1-1", 300), trip("1-2", 3100)});
  REQUIRE(slow.verdict == Verdict::poor);
  REQUIRE(slow.measured.find("1-2") != std::string::npos);
}

TEST_CASE("A diagnosis names every check once, and a cure with whatever is not good") {
  const Diagnosis diagnosis = diagnose(0.1, {});
  const nlohmann::ordered_json json = to_json(diagnosis);
  std::vector<std::string> names;
  for (const auto& check : json["checks"]) {
    CAPTURE(check.dump());
    names.push_back(check["name"]);
    REQUIRE_FALSE(check["measured"].get<std::string>().empty());
    if (check["verdict"] == "good") REQUIRE(check["cure"].is_null());
    if (check["verdict"] == "poor" || check["verdict"] == "fair") {
      REQUIRE_FALSE(check["cure"].is_null());
    }
  }
  REQUIRE(names == std::vector<std::string>{"wake_up", "scheduling", "memory_lock", "throttling",
                                            "control_group", "governor", "idle_states",
                                            "cpu_latency", "usb_interrupts", "kernel", "virtual",
                                            "processors", "devices", "usb_round_trip"});
  const std::string text = to_text(diagnosis);
  for (const std::string& name : names) REQUIRE(text.find(name) != std::string::npos);
  REQUIRE(text.find(to_string(diagnosis.verdict)) != std::string::npos);
}

}  // namespace doctor_test
