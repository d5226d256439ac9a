// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/stability/report/tried_case.hpp"

#include <algorithm>
#include <utility>

#include "baker/base/bake_error.hpp"
#include "tests/stability/catalogue/catalogue.hpp"
#include "tests/stability/laboratory/contestants.hpp"
#include "tests/stability/sixdof/sixdof_laboratory.hpp"

namespace spm::stability {
namespace {

/// Prepares what a contender needs of an object.
void make_part(const PreparedObject& object, const std::string& method) {
  if (method == "paper") {
    static_cast<void>(object.paper());
  } else if (method == "distance-field") {
    static_cast<void>(object.distance_field());
  } else if (method == "mesh-proxy") {
    static_cast<void>(object.float_mesh());
  } else if (method == "exact-penalty") {
    static_cast<void>(object.model());
  } else {
    static_cast<void>(object.sparse());
  }
}

}  // namespace

const std::string& TriedCase::name() const noexcept {
  return std::visit([](const auto& one) -> const std::string& { return one.name; }, tried_);
}

const std::string& TriedCase::title() const noexcept {
  return std::visit([](const auto& one) -> const std::string& { return one.title; }, tried_);
}

double TriedCase::of_border() const noexcept { return three() != nullptr ? three()->of_border : 0; }

bool TriedCase::has_border() const noexcept { return three() == nullptr || !three()->is_carried; }

void TriedCase::coarsen(double tolerance) noexcept {
  std::visit([tolerance](auto& one) { one.tolerance = std::max(one.tolerance, tolerance); },
             tried_);
}

std::string TriedCase::prepare(const std::vector<Contender>& contenders) {
  if (three() != nullptr) {
    std::string reason = why_unprepared(*three());
    if (!reason.empty()) return reason;
  }
  try {
    const PreparedObject* object = nullptr;
    if (three() != nullptr) {
      object = &prepared_object(*three());
    } else {
      scene_ = &sixdof_scene(std::get<SixdofCase>(tried_));
      object = &scene_->object();
    }
    for (const Contender& contender : contenders) {
      if (why_not(contender).empty()) make_part(*object, contender.method);
    }
  } catch (const baker::BakeError& error) {
    return error.what();
  }
  return {};
}

std::string TriedCase::why_not(const Contender& contender) const {
  return three() != nullptr ? stability::why_not(contender, *three())
                            : why_not_sixdof(contender, std::get<SixdofCase>(tried_));
}

CaseVerdict TriedCase::verdict(const RunSettings& settings, const Contender& contender,
                               int max_seeds) const {
  if (three() != nullptr) return case_verdict(*three(), settings, contender, max_seeds);
  return sixdof_verdict(std::get<SixdofCase>(tried_), *scene_, settings, contender, max_seeds);
}

double TriedCase::border(const RunSettings& settings, const Contender& contender, double low,
                         double high, double share, int max_seeds) const {
  if (three() != nullptr) {
    return case_border(*three(), settings, contender, low, high, share, max_seeds);
  }
  return sixdof_border(std::get<SixdofCase>(tried_), *scene_, settings, contender, low, high, share,
                       max_seeds);
}

std::vector<TriedCase> tried_cases() {
  std::vector<TriedCase> all;
  for (StabilityCase& one : whole_catalogue()) all.emplace_back(std::move(one));
  for (SixdofCase& one : sixdof_catalogue()) all.emplace_back(std::move(one));
  return all;
}

}  // namespace spm::stability
