// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/replay.hpp"

#include <algorithm>
#include <optional>

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

SceneChange change_in(const RecordingRow& row) {
  if ((row.flags & recorded_edited) != 0) return SceneChange::edit;
  return (row.flags & recorded_touched) != 0 ? SceneChange::application : SceneChange::none;
}

}  // namespace

ReplayResult replay(std::span<const AssetView* const> assets,
                    const std::vector<TrajectorySample>& trajectory, const ReplayOptions& options) {
  ReplayResult result;
  result.contacts.resize(trajectory.size());
  result.busy_ns.resize(trajectory.size());
  TickSchedule schedule(now_ns() + lead_ns, options.rate_hz);
  const auto added =
      std::count_if(options.steps.begin(), options.steps.end(),
                    [](const ReplayStep& step) { return step.step.kind == RecordedKind::added; });
  SceneForce force(options.scene, 1 / options.rate_hz, options.encoder_step,
                   static_cast<std::size_t>(added), options.limits);
  for (std::size_t i = 0; i < options.gone.size(); ++i) {
    if (options.gone[i]) force.remove(i);
  }
  auto step = options.steps.begin();
  for (std::size_t row = 0; row < trajectory.size(); ++row) {
    if (options.pace == Pace::realtime) {
      sleep_until(schedule.due());
      schedule.advance(now_ns());
    }
    for (; step != options.steps.end() && step->row <= row; ++step) apply(step->step, force);
    const ReplayMark mark = options.marks.empty() ? ReplayMark{} : options.marks[row];
    if (mark.forgot || mark.off) force.reset();
    const std::int64_t begin = now_ns();
    if (!mark.off) {
      result.contacts[row] =
          force.next(assets, trajectory[row].position, mark.ticks, ForceBudget::again(mark.effort));
    }
    result.busy_ns[row] = now_ns() - begin;
    if (mark.sent) force.sent(*mark.sent);
  }
  return result;
}

RecordedTicks ticks_of(const Recording& recording, std::size_t device) {
  RecordedTicks ticks;
  std::optional<std::uint64_t> last;
  std::size_t free = 0;
  bool settled = false;
  for (const RecordingRow& row : recording.rows) {
    if (row.device != device) continue;
    const auto vector = [](const std::array<double, 3>& v) { return Vector3(v[0], v[1], v[2]); };
    ticks.trajectory.push_back({vector(row.position)});
    const std::uint64_t since = last && row.tick > *last ? row.tick - *last : 1;
    last = row.tick;
    const Vector3 wanted = vector(row.wanted), added = vector(row.added);
    ticks.marks.push_back({(row.flags & recorded_forgot) != 0, row.cause != 0, since,
                           contact_part(vector(row.sent), wanted, added),
                           ForceEffort{row.first, row.exact, row.held, row.shortened}});
    ticks.wanted.push_back(wanted);
    ticks.added += added == Vector3::Zero() ? 0 : 1;
    ticks.ticks.push_back(row.tick);
    free = (row.flags & recorded_contact) == 0 ? free + 1 : 0;
    settled =
        settled || (row.flags & recorded_forgot) != 0 || row.cause != 0 || free > settling_ticks;
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

ForceDifference difference(const ReplayResult& result, std::span<const Vector3> wanted,
                           std::size_t from) {
  ForceDifference found;
  for (std::size_t row = from; row < wanted.size(); ++row) {
    const Vector3& force = result.contacts[row].force;
    if (force == wanted[row]) continue;
    if (found.ticks++ == 0) found.first_row = row;
    found.largest = std::max(found.largest, (force - wanted[row]).norm());
  }
  return found;
}

std::size_t caught_up(const ReplayResult& result, std::span<const Vector3> wanted) {
  std::size_t equal = 0, touching = 0;
  for (std::size_t row = 0; row < wanted.size(); ++row) {
    const ContactForce& contact = result.contacts[row];
    const bool same = contact.force == wanted[row];
    equal = same ? equal + 1 : 0;
    if (equal == 0) touching = 0;
    touching += same && contact.contact ? 1 : 0;
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
  Result<TraceCsv> table = TraceCsv::create(path);
  if (!table) return tl::make_unexpected(std::move(table.error()));
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    TraceRow row;
    row.t = static_cast<double>(i) / rate_hz;
    row.position = trajectory[i].position;
    row.force = result.contacts[i].force;
    row.depth = result.contacts[i].depth;
    row.contact = result.contacts[i].contact;
    table->append(row);
  }
  return table->commit();
}

}  // namespace spm::servo
