// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/replay.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "formats/motion/row_vectors.hpp"
#include "servo/base/clock.hpp"
#include "servo/base/schedule.hpp"
#include "servo/force/contact_part.hpp"
#include "servo/record/trace_csv.hpp"

namespace spm::servo {

namespace {

constexpr std::int64_t lead_ns = 2'000'000;

/// After so many ticks without contact the longest memory of the force law, that of the noise of
/// readings, is gone to the last bit: 64 ticks to each factor of e, and 53 bits.
constexpr std::size_t settling_ticks = 3000;

/// So many equal forces in contact are no chance.
constexpr std::size_t touching_ticks = 100;

TickOfTool tick_of(const SceneForce& force) {
  const ToolTick& tool = force.tool();
  return {{tool.pose.translation(), Eigen::Quaterniond(tool.pose.linear())},
          static_cast<std::uint32_t>(tool.patch_count),
          force.effort().level,
          force.effort().culled,
          tool.capped};
}

/// Whether a force is the recorded one in every bit.
bool same(const ContactForce& now, const Wrench& then) {
  return now.force == then.force && now.torque == then.torque;
}

TrajectorySample sample_of(const RecordingRow& row) {
  const auto& turn = row.orientation;
  return {vector_of(row.position), turn[0], turn[1], turn[2], turn[3]};
}

/// How the force law was asked in that tick; the tool's level belongs to it.
ForceEffort effort_of(const RecordingRow& row) {
  ForceEffort effort;
  effort.first = row.first;
  effort.exact = row.exact;
  effort.held = row.held;
  effort.shortened = row.shortened;
  effort.level = row.level;
  effort.refined = row.refined;
  effort.worked = row.worked;
  return effort;
}

SceneChange change_in(const RecordingRow& row) {
  if ((row.flags & recorded_edited) != 0) return SceneChange::edit;
  return (row.flags & recorded_touched) != 0 ? SceneChange::application : SceneChange::none;
}

}  // namespace

namespace {

/// One hand in a replay.
class Replayed {
 public:
  Replayed(std::span<const AssetView* const> assets, const ReplayHand& hand)
      : assets_(assets), hand_(hand), options_(*hand.options), force_(force_of(options_)) {
    const std::size_t rows = hand.trajectory.size();
    result_.contacts.resize(rows);
    result_.busy_ns.resize(rows);
    if (options_.scene.tool) {
      force_.take_tool(options_.tool, memory_of(options_.scene, options_.hand));
      result_.tools.resize(rows);
    }
    for (std::size_t i = 0; i < options_.gone.size(); ++i) {
      if (options_.gone[i]) force_.remove(i);
    }
    step_ = options_.steps.begin();
  }

  [[nodiscard]] bool done() const { return row_ == hand_.trajectory.size(); }
  [[nodiscard]] std::uint64_t tick() const { return hand_.ticks[row_]; }
  [[nodiscard]] SceneForce& force() { return force_; }
  [[nodiscard]] ReplayResult& result() { return result_; }

  /// The next row.
  void next() {
    for (; step_ != options_.steps.end() && step_->row <= row_; ++step_) {
      apply(step_->step, force_);
    }
    const ReplayMark mark = options_.marks.empty() ? ReplayMark{} : options_.marks[row_];
    if (mark.forgot) force_.reset();
    if (mark.off) force_.rest();
    const std::int64_t begin = now_ns();
    if (!mark.off) {
      result_.contacts[row_] = force_.next(assets_, hand_.trajectory[row_].pose(), mark.ticks,
                                           ForceBudget::again(mark.effort));
    }
    result_.busy_ns[row_] = now_ns() - begin;
    if (options_.scene.tool && !mark.off) result_.tools[row_] = tick_of(force_);
    if (mark.sent) force_.sent(*mark.sent);
    ++row_;
  }

 private:
  [[nodiscard]] static SceneForce force_of(const ReplayOptions& options) {
    const auto added =
        std::count_if(options.steps.begin(), options.steps.end(),
                      [](const ReplayStep& step) { return step.step.kind == RecordedKind::added; });
    return SceneForce(options.scene, 1 / options.rate_hz, options.encoder_step,
                      static_cast<std::size_t>(added), options.limits, options.turning,
                      options.hand);
  }

  std::span<const AssetView* const> assets_;
  ReplayHand hand_;
  const ReplayOptions& options_;
  SceneForce force_;
  ReplayResult result_;
  std::vector<ReplayStep>::const_iterator step_;
  std::size_t row_ = 0;
};

}  // namespace

ReplayResult replay(std::span<const AssetView* const> assets,
                    const std::vector<TrajectorySample>& trajectory, const ReplayOptions& options) {
  Replayed hand(assets, {trajectory, {}, &options});
  TickSchedule schedule(now_ns() + lead_ns, options.rate_hz);
  while (!hand.done()) {
    if (options.pace == Pace::realtime) {
      sleep_until(schedule.due());
      schedule.advance(now_ns());
    }
    hand.next();
  }
  return std::move(hand.result());
}

std::vector<ReplayResult> replay_together(std::span<const AssetView* const> assets,
                                          std::span<const ReplayHand> hands) {
  std::vector<std::unique_ptr<Replayed>> played;
  std::vector<SceneForce*> forces;
  for (const ReplayHand& hand : hands) {
    played.push_back(std::make_unique<Replayed>(assets, hand));
    forces.push_back(&played.back()->force());
  }
  for (SceneForce* force : forces) force->meet(forces);
  for (;;) {
    Replayed* next = nullptr;
    for (const auto& hand : played) {
      if (!hand->done() && (next == nullptr || hand->tick() < next->tick())) next = hand.get();
    }
    if (next == nullptr) break;
    next->next();
  }
  std::vector<ReplayResult> results;
  results.reserve(played.size());
  for (const auto& hand : played) results.push_back(std::move(hand->result()));
  return results;
}

RecordedTicks ticks_of(const Recording& recording, std::size_t device) {
  RecordedTicks ticks;
  std::optional<std::uint64_t> last;
  std::size_t free = 0;
  bool settled = false;
  for (const RecordingRow& row : recording.rows) {
    if (row.device != device) continue;
    ticks.trajectory.push_back(sample_of(row));
    const std::uint64_t since = last && row.tick > *last ? row.tick - *last : 1;
    last = row.tick;
    const Wrench wanted{vector_of(row.wanted), vector_of(row.wanted_torque)};
    const Wrench added{vector_of(row.added), vector_of(row.added_torque)};
    const Wrench sent{vector_of(row.sent), vector_of(row.sent_torque)};
    const bool off = row.cause != 0 && (row.flags & recorded_kept) == 0;
    ReplayMark mark{(row.flags & recorded_forgot) != 0, off, since, {}, effort_of(row)};
    if (row.cause == 0) mark.sent = contact_part(sent, wanted, added);
    ticks.marks.push_back(mark);
    ticks.wanted.push_back(wanted);
    const bool pushed = added.force != Vector3::Zero() || added.torque != Vector3::Zero();
    ticks.added += pushed ? 1 : 0;
    ticks.ticks.push_back(row.tick);
    free = (row.flags & recorded_contact) == 0 ? free + 1 : 0;
    settled = settled || (row.flags & recorded_forgot) != 0 || free > settling_ticks;
    ticks.settled += settled ? 0 : 1;
    ticks.lost += (row.flags & recorded_lost) != 0 ? 1 : 0;
    if (ticks.change != SceneChange::none) continue;
    ticks.change = change_in(row);
    ticks.changed_tick = row.tick;
    ticks.comparable += ticks.change == SceneChange::none ? 1 : 0;
  }
  return ticks;
}

std::vector<ReplayStep> steps_before(const std::vector<SceneStep>& steps,
                                     const std::vector<std::uint64_t>& ticks) {
  std::vector<ReplayStep> list;
  std::size_t row = 0;
  for (const SceneStep& step : steps) {
    while (row < ticks.size() && ticks[row] < step.tick) ++row;
    if (row == ticks.size()) break;
    list.push_back({row, step});
  }
  return list;
}

ForceDifference difference(const ReplayResult& result, std::span<const Wrench> wanted,
                           std::size_t from) {
  ForceDifference found;
  for (std::size_t row = from; row < wanted.size(); ++row) {
    const ContactForce& contact = result.contacts[row];
    if (same(contact, wanted[row])) continue;
    if (found.ticks++ == 0) found.first_row = row;
    found.largest = std::max(found.largest, (contact.force - wanted[row].force).norm());
    found.largest_torque =
        std::max(found.largest_torque, (contact.torque - wanted[row].torque).norm());
  }
  return found;
}

std::size_t caught_up(const ReplayResult& result, std::span<const Wrench> wanted) {
  std::size_t equal = 0, touching = 0;
  for (std::size_t row = 0; row < wanted.size(); ++row) {
    const ContactForce& contact = result.contacts[row];
    equal = same(contact, wanted[row]) ? equal + 1 : 0;
    if (equal == 0) touching = 0;
    touching += equal > 0 && contact.contact ? 1 : 0;
    if (equal >= settling_ticks && touching >= touching_ticks) return row + 1 - equal;
  }
  return wanted.size();
}

Summary us_per_tick(const ReplayResult& result) {
  std::vector<double> times;
  times.reserve(result.busy_ns.size());
  for (const std::int64_t busy : result.busy_ns) times.push_back(static_cast<double>(busy) * 1e-3);
  return summarise(times);
}

Summary force_steps(const ReplayResult& result) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < result.contacts.size(); ++i) {
    steps.push_back((result.contacts[i].force - result.contacts[i - 1].force).norm());
  }
  return summarise(steps);
}

std::uint64_t contact_ticks(const ReplayResult& result) {
  return static_cast<std::uint64_t>(
      std::count_if(result.contacts.begin(), result.contacts.end(),
                    [](const ContactForce& contact) { return contact.contact; }));
}

Result<void> write_replay(const std::string& path, const std::vector<TrajectorySample>& trajectory,
                          const ReplayResult& result, double rate_hz) {
  Result<TraceCsv> table = TraceCsv::create(path, !result.tools.empty());
  if (!table) return tl::make_unexpected(std::move(table.error()));
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    TraceRow row;
    row.t = static_cast<double>(i) / rate_hz;
    row.position = trajectory[i].position;
    row.orientation = trajectory[i].pose().orientation;
    row.force = result.contacts[i].force;
    row.torque = result.contacts[i].torque;
    row.depth = result.contacts[i].depth;
    row.contact = result.contacts[i].contact;
    if (!result.tools.empty()) {
      row.tool = result.tools[i].pose;
      row.patches = result.tools[i].patches;
      row.level = result.tools[i].level;
      row.culled = result.tools[i].culled;
      row.tool_capped = result.tools[i].capped;
    }
    table->append(row);
  }
  return table->commit();
}

}  // namespace spm::servo
