// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/batch.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>

#include "baker/batch/cost.hpp"
#include "baker/batch/workers.hpp"

namespace spm::baker {
namespace {

/// A bake that is under way.
struct Running {
  unsigned threads = 0;
  double memory = 0;  ///< bytes, by estimate
  double done = 0;    ///< of its stage
  std::string stage;
};

class Batch {
 public:
  Batch(const Manifest& manifest, const BatchOptions& options, const BatchListener& listener)
      : entries_(manifest.entries),
        options_(options),
        listener_(listener),
        outcomes_(checked_before(manifest)) {
    for (const ManifestEntry& entry : entries_) costs_.push_back(estimated_cost(entry.request));
    for (const double cost : costs_) work_ += cost;
    failed_ = std::any_of(outcomes_.begin(), outcomes_.end(),
                          [](const AssetOutcome& outcome) { return outcome.known; });
  }

  std::vector<AssetOutcome> run() {
    tell();
    while (start_next() || !running_.empty()) {
      if (may_start()) continue;
      const JobEvent event = workers_.wait();
      if (event.ended) {
        finish(event);
      } else {
        running_[event.job].stage = event.stage;
        running_[event.job].done = event.done;
      }
      tell_progress();
    }
    // Nothing before the last one told is missing, but after a failure some were never begun.
    for (; told_ < entries_.size(); ++told_) tell_one(told_);
    return std::move(outcomes_);
  }

 private:
  /// Passes over what has failed before it began.
  void skip_known() {
    while (next_ < entries_.size() && outcomes_[next_].known) ++next_;
  }

  bool may_start() {
    skip_known();
    return next_ < entries_.size() && running_.size() < options_.jobs &&
           (!failed_ || options_.keep_going) && fits_in_memory();
  }

  /// Whether the next bake fits beside those that run. Alone, each has to be tried.
  [[nodiscard]] bool fits_in_memory() const {
    if (!options_.memory || running_.empty()) return true;
    double taken = estimated_memory(entries_[next_].request);
    for (const auto& [job, running] : running_) taken += running.memory;
    return taken <= static_cast<double>(*options_.memory);
  }

  /// Starts one bake where there is one and room for it.
  bool start_next() {
    if (!may_start()) return false;
    unsigned free = options_.cores;
    for (const auto& [job, running] : running_) free -= std::min(free, running.threads);
    const std::size_t left = entries_.size() - next_;
    const auto beginning =
        static_cast<unsigned>(std::min<std::size_t>(options_.jobs - running_.size(), left));
    BuildRequest request = entries_[next_].request;
    if (request.bake.threads == 0) request.bake.threads = thread_share(free, beginning);
    const Cache* cache = options_.cache ? &*options_.cache : nullptr;
    const Job job = [request, cache](const Progress& progress) {
      return encoded(built_outcome(cache, request, progress));
    };
    if (workers_.start(next_, job)) {
      running_[next_].threads = request.bake.threads;
      running_[next_].memory = estimated_memory(request);
    } else {
      outcomes_[next_] =
          failed_outcome({ExitCode::internal, fmt::format("{}: no process for its bake: {}; try a "
                                                          "smaller -j",
                                                          request.mesh, std::strerror(errno))});
      failed_ = true;
    }
    ++next_;
    return true;
  }

  void finish(const JobEvent& event) {
    running_.erase(event.job);
    AssetOutcome& outcome = outcomes_[event.job];
    outcome = outcome_of(event, entries_[event.job].request);
    failed_ = failed_ || !outcome.ok();
    if (outcome.ok() && outcome.report.value("cache", "") == "hit") {
      work_ -= costs_[event.job];  // says nothing of the pace of those that are baked
    } else {
      worked_ += costs_[event.job];
    }
    ++ended_;
    tell();
  }

  void tell_one(std::size_t index) {
    if (outcomes_[index].known && listener_.told) listener_.told(entries_[index], outcomes_[index]);
  }

  /// Tells what has become known in the manifest's order.
  void tell() {
    while (told_ < entries_.size() && outcomes_[told_].known) tell_one(told_++);
  }

  void tell_progress() const {
    if (!listener_.progress || running_.empty()) return;
    double worked = worked_;
    for (const auto& [job, running] : running_) {
      // Stages follow each other, and nobody knows how many; half is as good a guess as any.
      worked += costs_[job] * running.done / 2;
    }
    const auto& [job, running] = *running_.begin();
    listener_.progress(work_ > 0 ? worked / work_ : 0,
                       fmt::format("{} of {} assets, {}: {}", ended_, entries_.size(),
                                   entries_[job].name, running.stage));
  }

  const std::vector<ManifestEntry>& entries_;
  const BatchOptions& options_;
  const BatchListener& listener_;
  std::vector<AssetOutcome> outcomes_;
  std::vector<double> costs_;
  Workers workers_;
  std::map<std::size_t, Running> running_;
  std::size_t next_ = 0;   ///< the first that was not begun
  std::size_t told_ = 0;   ///< the first that was not told
  std::size_t ended_ = 0;  ///< bakes
  double work_ = 0, worked_ = 0;
  bool failed_ = false;
};

}  // namespace

unsigned thread_share(unsigned free, unsigned beginning) {
  return std::max(1U, beginning > 0 ? free / beginning : free);
}

std::vector<AssetOutcome> checked_before(const Manifest& manifest) {
  std::vector<AssetOutcome> outcomes(manifest.entries.size());
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const ManifestEntry& entry = manifest.entries[i];
    const int mesh = ::open(entry.request.mesh.c_str(), O_RDONLY | O_CLOEXEC);
    if (mesh < 0) {
      outcomes[i] = failed_outcome(
          {ExitCode::file_or_device,
           fmt::format("{}: line {}: 'mesh': {} cannot be opened: {}; check the name",
                       manifest.path, entry.mesh_line, entry.request.mesh, std::strerror(errno))});
      continue;
    }
    ::close(mesh);
    if (const Result<void> writable = check_new_output(entry.request.output); !writable) {
      outcomes[i] = failed_outcome(
          {writable.error().code, fmt::format("{}: line {}: 'output': {}", manifest.path,
                                              entry.output_line, writable.error().message)});
    }
  }
  return outcomes;
}

std::vector<AssetOutcome> run_batch(const Manifest& manifest, const BatchOptions& options,
                                    const BatchListener& listener) {
  return Batch(manifest, options, listener).run();
}

}  // namespace spm::baker
