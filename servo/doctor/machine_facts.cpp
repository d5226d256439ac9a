// SPDX-License-Identifier: Apache-2.0
#include "servo/doctor/machine_facts.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace spm::servo {

namespace {

namespace fs = std::filesystem;

/// First line of a file; empty if it cannot be read.
std::string line_of(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// A number at the start of a text, in any locale.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number value{};
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc{} || parsed.ptr == text.data()) return std::nullopt;
  return value;
}

/// The value of a "name: value" line; nothing if there is none.
std::optional<std::string> field_of(const std::string& path, std::string_view name) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(name)) return line.substr(std::min(line.size(), line.find(':')));
  }
  return std::nullopt;
}

bool has_word(const std::string& text, std::string_view word) {
  const std::string spaced = " " + text + " ";
  return spaced.find(fmt::format(" {} ", word)) != std::string::npos;
}

void read_kernel(const std::string& root, MachineFacts& facts) {
  facts.kernel_release = line_of(root + "/proc/sys/kernel/osrelease");
  facts.kernel_version = line_of(root + "/proc/sys/kernel/version");
  facts.realtime_kernel =
      line_of(root + "/sys/kernel/realtime") == "1" || has_word(facts.kernel_version, "PREEMPT_RT");
  facts.rt_runtime_us =
      number_of<std::int64_t>(line_of(root + "/proc/sys/kernel/sched_rt_runtime_us"));
  facts.rt_period_us =
      number_of<std::int64_t>(line_of(root + "/proc/sys/kernel/sched_rt_period_us"));
  facts.load = number_of<double>(line_of(root + "/proc/loadavg"));
  if (const auto flags = field_of(root + "/proc/cpuinfo", "flags")) {
    facts.is_virtual = has_word(*flags, "hypervisor");
  }
}

void read_processors(const std::string& root, MachineFacts& facts) {
  const std::string folder = root + "/sys/devices/system/cpu";
  facts.online_list = line_of(folder + "/online");
  facts.online = count_of_list(facts.online_list);
  facts.isolated = line_of(folder + "/isolated");
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with("cpu") || !number_of<unsigned>(std::string_view(name).substr(3))) {
      continue;
    }
    const std::string governor = line_of(entry->path() / "cpufreq/scaling_governor");
    if (!governor.empty()) facts.governors.push_back(governor);
  }
  std::sort(facts.governors.begin(), facts.governors.end());
}

void read_idle_states(const std::string& root, MachineFacts& facts) {
  const std::string folder = root + "/sys/devices/system/cpu/cpu0/cpuidle/state";
  for (int i = 0;; ++i) {
    const std::string state = folder + std::to_string(i);
    const auto exit_us = number_of<double>(line_of(state + "/latency"));
    if (!exit_us) break;
    if (line_of(state + "/disable") == "1") continue;
    if (facts.idle_exit_us && *facts.idle_exit_us >= *exit_us) continue;
    facts.idle_exit_us = exit_us;
    facts.idle_state = line_of(state + "/name");
  }
  const std::string latency = root + "/dev/cpu_dma_latency";
  facts.has_latency = access(latency.c_str(), F_OK) == 0;
  facts.may_hold_latency = access(latency.c_str(), W_OK) == 0;
}

/// Lines such as " 24:  7  0  PCI-MSI 327680-edge  xhci_hcd". Controllers of USB 1 to 3 are named
/// after their drivers, with a bus behind a colon.
void read_usb_interrupts(const std::string& root, MachineFacts& facts) {
  std::ifstream file(root + "/proc/interrupts");
  for (std::string line; std::getline(file, line);) {
    const std::size_t found = line.find("hci_hcd");
    const std::size_t begin = line.find_first_not_of(' ');
    if (found == std::string::npos) continue;
    const auto number = number_of<unsigned>(std::string_view(line).substr(begin));
    if (!number) continue;
    const std::size_t name = line.rfind(' ', found) + 1;
    facts.usb_interrupts.push_back(
        {*number, line.substr(name, line.find_first_of(" ,", found) - name),
         line_of(fmt::format("{}/proc/irq/{}/smp_affinity_list", root, *number))});
  }
}

/// The group of this process in the unified hierarchy; a process is in exactly one group.
std::string own_group(const std::string& root) {
  std::ifstream file(root + "/proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("0::/")) return line.substr(3);
  }
  return {};
}

/// Reads "QUOTA PERIOD", microseconds, or "max PERIOD".
std::optional<double> processors_of_quota(const std::string& text) {
  const std::size_t blank = text.find(' ');
  if (blank == std::string::npos) return std::nullopt;
  const auto quota = number_of<double>(text);
  const auto period = number_of<double>(std::string_view(text).substr(blank + 1));
  if (!quota || !period || !(*period > 0)) return std::nullopt;
  return *quota / *period;
}

void read_cgroup(const std::string& root, MachineFacts& facts) {
  const std::string mount = root + "/sys/fs/cgroup";
  std::error_code ignored;
  std::string group = own_group(root);
  facts.has_cgroup = !group.empty() && fs::exists(mount + "/cgroup.controllers", ignored);
  if (!facts.has_cgroup) return;
  // The limit of each group above this one applies as well.
  while (true) {
    const auto processors = processors_of_quota(line_of(mount + group + "/cpu.max"));
    if (processors && (!facts.quota || *processors < facts.quota->processors)) {
      facts.quota = CpuQuota{group.empty() ? "/" : group, *processors};
    }
    if (group.empty() || group == "/") break;
    group.erase(group.rfind('/'));
  }
}

}  // namespace

std::vector<std::size_t> cores_of_list(const std::string& list) {
  constexpr std::size_t most = 65536;  // far more than any kernel can have
  std::vector<std::size_t> cores;
  std::string_view rest = list;
  while (!rest.empty()) {
    const std::size_t comma = rest.find(',');
    const std::string_view range = rest.substr(0, comma);
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
    const std::size_t dash = range.find('-');
    const auto first = number_of<std::size_t>(range);
    const auto last =
        dash == std::string_view::npos ? first : number_of<std::size_t>(range.substr(dash + 1));
    if (!first || !last || *last < *first || *last >= most) return {};
    for (std::size_t core = *first; core <= *last; ++core) cores.push_back(core);
  }
  return cores;
}

std::size_t count_of_list(const std::string& list) { return cores_of_list(list).size(); }

MachineFacts read_machine(const std::string& root) {
  MachineFacts facts;
  read_kernel(root, facts);
  read_processors(root, facts);
  read_idle_states(root, facts);
  read_usb_interrupts(root, facts);
  read_cgroup(root, facts);
  return facts;
}

}  // namespace spm::servo
