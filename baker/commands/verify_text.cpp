// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/commands/verify_text.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <numbers>

#include "common/base/units.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

constexpr double degrees = 180 / std::numbers::pi;
constexpr double micro = 1e6;

std::string length(double metres) { return format_quantity(metres, Quantity::length); }

/// 1234567 as 1,234,567.
std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, 1, ',');
  return text;
}

std::string none_or(std::uint64_t number) { return number == 0 ? "none" : grouped(number); }

std::string place_of(const Vector3& point) {
  return fmt::format("({:.7g}, {:.7g}, {:.7g}) m", point.x(), point.y(), point.z());
}

Json to_json(const Vector3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json to_json(const ErrorSummary& error) {
  return {{"rms", error.rms * micro},
          {"p50", error.p50 * micro},
          {"p99", error.p99 * micro},
          {"p999", error.p999 * micro},
          {"max", error.max * micro}};
}

Json to_json(const Counts& counts) {
  return {{"unanswered", counts.unanswered},
          {"wrong_side", counts.wrong_side},
          {"beyond_tolerance", counts.beyond_tolerance},
          {"pruned", counts.pruned},
          {"doubtful_gaps", counts.doubtful_gaps}};
}

Json to_json(const AdversarialReport& hard) {
  return {{"samples", hard.samples},
          {"distance_error_um", to_json(hard.distance)},
          {"misclassified",
           {{"inside_as_outside", hard.inside_as_outside},
            {"outside_as_inside", hard.outside_as_inside}}},
          {"unanswered", hard.unanswered},
          {"counts", to_json(hard.counts)},
          {"worst_point_m", to_json(hard.worst_point)}};
}

Json to_json(const DirectionSummary& direction) {
  return {{"p50", direction.p50 * degrees},
          {"p99", direction.p99 * degrees},
          {"max", direction.max * degrees}};
}

Json to_json(const JumpReport& jumps) {
  return {{"places", jumps.places},
          {"borders", jumps.borders},
          {"distance_um", to_json(jumps.distance)},
          {"direction_deg", to_json(jumps.direction)},
          {"contested", jumps.contested},
          {"contested_direction_deg", to_json(jumps.contested_direction)},
          {"allowed_um", jumps.allowed * micro},
          {"beyond", jumps.beyond},
          {"worst_point_m", to_json(jumps.worst_point)}};
}

Json to_json(const WorstPlace& place) {
  return {{"point", to_json(place.point)},
          {"error_um", place.error ? Json(*place.error * micro) : Json()},
          {"kind", name_of(place.kind)},
          {"exact_distance_m", place.truth},
          {"hard", place.hard}};
}

std::string line_of(const char* what, const ErrorSummary& error) {
  return fmt::format("{:<14} rms {:.3g} um, p50 {:.3g}, p99 {:.3g}, p99.9 {:.3g}, max {:.3g}\n",
                     what, error.rms * micro, error.p50 * micro, error.p99 * micro,
                     error.p999 * micro, error.max * micro);
}

std::string direction_lines(const VerifyReport& report) {
  std::string text = fmt::format("direction      p50 {:.3g} deg, p99 {:.3g}, max {:.3g}\n",
                                 report.direction_p50 * degrees, report.direction_p99 * degrees,
                                 report.direction_max * degrees);
  if (report.direction_contested > 0) {
    text += fmt::format(
        "contested      {:.1f} % of the places, where several directions compete, are not in the "
        "line above; from the nearest of these: p50 {:.3g} deg, p99 {:.3g}, max {:.3g}\n",
        100 * report.direction_contested, report.contested_p50 * degrees,
        report.contested_p99 * degrees, report.contested_max * degrees);
  }
  return text;
}

/// How far answers jump where leaves of the octree meet.
std::string jump_lines(const JumpReport& jumps) {
  if (jumps.places == 0) return {};
  std::string text = fmt::format(
      "jumps          p50 {:.3g} um, p99 {:.3g}, max {:.3g}; p50 {:.3g} deg, p99 {:.3g}, max "
      "{:.3g}; at {} places on {} borders of leaves, {} beyond {}\n",
      jumps.distance.p50 * micro, jumps.distance.p99 * micro, jumps.distance.max * micro,
      jumps.direction.p50 * degrees, jumps.direction.p99 * degrees, jumps.direction.max * degrees,
      grouped(jumps.places), grouped(jumps.borders), none_or(jumps.beyond), length(jumps.allowed));
  if (jumps.contested > 0) {
    text += fmt::format(
        "contested      {} of these places lie where several directions compete; their jumps of "
        "direction are not in the line above: p50 {:.3g} deg, p99 {:.3g}, max {:.3g}\n",
        grouped(jumps.contested), jumps.contested_direction.p50 * degrees,
        jumps.contested_direction.p99 * degrees, jumps.contested_direction.max * degrees);
  }
  return text;
}

/// What the verdict leaves out, and how many places that are.
std::string left_out_lines(const VerifyReport& report) {
  if (const std::uint64_t pruned = report.counts.pruned + report.adversarial.counts.pruned;
      pruned > 0) {
    return fmt::format(
        "cut away       {} places ({:.1f} % of the samples), which the bake left out; not judged, "
        "not in the verdict\n",
        grouped(pruned), 100 * report.pruned);
  }
  return {};
}

/// How many places were judged by more than one distance.
std::string doubtful_line(const VerifyReport& report) {
  const std::uint64_t doubtful =
      report.counts.doubtful_gaps + report.adversarial.counts.doubtful_gaps;
  if (doubtful == 0) return {};
  return fmt::format(
      "gaps           {} places are right with a gap closed or open that is about as wide as those "
      "that are closed\n",
      grouped(doubtful));
}

std::string worst_lines(const std::vector<WorstPlace>& places) {
  std::string text;
  for (const WorstPlace& place : places) {
    text += fmt::format("worst          {:>12} {:<16} at {}{}\n",
                        place.error ? fmt::format("{:.4g} um", *place.error * micro) : "no answer",
                        name_of(place.kind), place_of(place.point), place.hard ? ", hard" : "");
  }
  return text;
}

/// The places and what is wrong with them, as the middle of a sentence.
std::string counted(const Counts& counts, std::uint64_t samples, const char* what,
                    double threshold) {
  std::string text =
      fmt::format("{} of {} {}", grouped(counts.missed()), grouped(samples - counts.pruned), what);
  if (counts.missed() > 0) {
    text += fmt::format(" ({} unanswered, {} beyond {}, {} on the wrong side)",
                        grouped(counts.unanswered), grouped(counts.beyond_tolerance),
                        length(threshold), grouped(counts.wrong_side));
  }
  return text;
}

std::string counted(const VerifyReport& report) {
  const AdversarialReport& hard = report.adversarial;
  std::string text = counted(report.counts, report.samples, "places", report.threshold) + " and " +
                     counted(hard.counts, hard.samples, "hard ones", report.threshold);
  if (const JumpReport& jumps = report.jumps; jumps.beyond > 0) {
    text += fmt::format("; {} of {} jumps between leaves beyond {}", grouped(jumps.beyond),
                        grouped(jumps.places), length(jumps.allowed));
  }
  return text;
}

}  // namespace

std::string verdict_of(const VerifyReport& report) {
  const AdversarialReport& hard = report.adversarial;
  const std::string seed = fmt::format(" (seed {})", report.seed);
  if (!report.tolerance) {
    return std::string(
               "no promise: the asset has no tolerance; missing or beyond 1/1000 of the "
               "diagonal: ") +
           counted(report) + seed;
  }
  if (report.judged() == 0) {
    return "MISSED: no place to judge, the bake left out all that were drawn" + seed;
  }
  if (report.passed()) {
    return fmt::format(
               "kept: 0 of {} places and 0 of {} hard ones beyond {}, none unanswered, none on the "
               "wrong side",
               grouped(report.samples - report.counts.pruned),
               grouped(hard.samples - hard.counts.pruned), length(*report.tolerance)) +
           seed;
  }
  return "MISSED: " + counted(report) + seed;
}

std::string describe(const VerifyReport& report) {
  std::string text =
      fmt::format("samples        {}, and {} hard ones, from {} inside to {} outside, seed {}\n",
                  grouped(report.samples), grouped(report.adversarial.samples),
                  length(report.band.max_depth), length(report.band.margin), report.seed);
  text += report.tolerance
              ? fmt::format("tolerance      {}, {} by what the bake recorded\n",
                            length(*report.tolerance), report.tolerance_met ? "met" : "NOT met")
              : fmt::format("tolerance      none; 1/1000 of the diagonal, {}, in its place\n",
                            length(report.threshold));
  text += line_of("distance error", report.distance);
  if (report.smoothing && report.total) {
    text += line_of("of smoothing", *report.smoothing);
    text += line_of("both together", *report.total);
  }
  text += direction_lines(report);
  text +=
      fmt::format("wrong side     {:.4g} % inside taken for outside, {:.4g} % outside for inside\n",
                  100 * report.inside_as_outside, 100 * report.outside_as_inside);
  text += fmt::format("unanswered     {:.4g} %\n", 100 * report.unanswered);
  text += line_of("at hard places", report.adversarial.distance);
  text += jump_lines(report.jumps);
  text += left_out_lines(report);
  text += doubtful_line(report);
  text += worst_lines(report.worst);
  return text + "verdict        " + verdict_of(report) + "\n";
}

Json to_json(const VerifyReport& report) {
  Json json;
  json["passed"] = report.passed();
  json["verdict"] = verdict_of(report);
  json["tolerance_um"] = report.tolerance ? Json(*report.tolerance * micro) : Json();
  json["tolerance_met"] = report.tolerance_met;
  json["judged_by_um"] = report.threshold * micro;
  json["seed"] = report.seed;
  json["samples"] = report.samples;
  json["counts"] = to_json(report.counts);
  json["distance_error_um"] = to_json(report.distance);
  json["histogram"] = {{"bins_to_um", report.threshold * micro}, {"counts", report.histogram}};
  if (report.smoothing) json["smoothing_error_um"] = to_json(*report.smoothing);
  if (report.total) json["total_error_um"] = to_json(*report.total);
  json["direction_error_deg"] = {{"p50", report.direction_p50 * degrees},
                                 {"p99", report.direction_p99 * degrees},
                                 {"max", report.direction_max * degrees}};
  json["directions"] = report.directions;
  json["direction_contested"] = report.direction_contested;
  json["direction_contested_error_deg"] = {{"p50", report.contested_p50 * degrees},
                                           {"p99", report.contested_p99 * degrees},
                                           {"max", report.contested_max * degrees}};
  json["misclassified"] = {{"inside_as_outside", report.inside_as_outside},
                           {"outside_as_inside", report.outside_as_inside}};
  json["unanswered"] = report.unanswered;
  json["pruned"] = report.pruned;
  json["not_judged"] = report.not_judged;
  json["fallback_answers"] = report.fallback_answers;
  json["adversarial"] = to_json(report.adversarial);
  json["jumps"] = report.jumps.places > 0 ? to_json(report.jumps) : Json();
  json["band_m"] = report.band.max_depth;
  json["margin_m"] = report.band.margin;
  json["worst_point_m"] = to_json(report.worst_point);
  json["worst"] = Json::array();
  for (const WorstPlace& place : report.worst) json["worst"].push_back(to_json(place));
  return json;
}

std::string to_ply(const std::vector<WorstPlace>& places) {
  /// One for each finding: violet, red, orange, grey.
  constexpr std::array colours{"160 32 240", "220 20 20", "255 140 0", "128 128 128"};
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\n"
      "comment places where an asset is worst, worst first; metres\n"
      "comment error_um is -1 where there is no answer\n"
      "comment kind 0 {}, 1 {}, 2 {}, 3 {}\n"
      "element vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property float error_um\nproperty uchar kind\n"
      "end_header\n",
      name_of(Finding::unanswered), name_of(Finding::wrong_side),
      name_of(Finding::beyond_tolerance), name_of(Finding::within), places.size());
  for (const WorstPlace& place : places) {
    const auto kind = static_cast<std::size_t>(place.kind);
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {:.6g} {}\n", place.point.x(),
                   place.point.y(), place.point.z(), colours.at(kind),
                   place.error ? *place.error * micro : -1, kind);
  }
  return text;
}

}  // namespace spm::baker
