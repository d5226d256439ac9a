// SPDX-License-Identifier: GPL-3.0-or-later
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <utility>

#include "tests/bench/methods/methods.hpp"
#include "tests/bench/model/query_asset.hpp"

namespace spm::bench {
namespace {

// The codes of the library equal the values of the enumerators.
static_assert(static_cast<int>(Status::pruned) == SPM_QUERY_PRUNED);
static_assert(static_cast<int>(Source::none) == SPM_QUERY_NONE);

Answer answer_of(const spm_query_answer& told) noexcept {
  Answer answer;
  answer.distance = told.distance;
  answer.normal = Vector3(told.normal[0], told.normal[1], told.normal[2]);
  answer.plane = told.plane;
  answer.layer = told.layer;
  answer.source = static_cast<Source>(told.source);
  answer.status = static_cast<Status>(told.status);
  return answer;
}

/// One point per call.
class Spm : public Method {
 public:
  Spm(const BakedFile& file, QueryAsset asset) : asset_(std::move(asset)) {
    facts_.name = "spm";
    facts_.settings = file.settings;
    facts_.setting = file.tolerance;
    facts_.tolerance = file.tolerance;
    facts_.file_bytes = file.bytes;
    facts_.resident_bytes = spm_query_memory(asset_.get());
    facts_.build_seconds = file.seconds;
    facts_.open_seconds = file.open_seconds;
  }

  [[nodiscard]] Answer query(const Vector3& point) const noexcept override {
    spm_query_answer told;
    spm_query_point(asset_.get(), point.data(), &told);
    return answer_of(told);
  }

 protected:
  QueryAsset asset_;
};

/// As many points a call as there are.
class SpmBatch final : public Spm {
 public:
  SpmBatch(const BakedFile& file, QueryAsset asset) : Spm(file, std::move(asset)) {
    facts_.settings += ", batch";
  }

  void query_all(std::span<const Vector3> points,
                 std::span<Answer> answers) const noexcept override {
    static_assert(sizeof(Vector3) == 3 * sizeof(double));
    std::array<spm_query_answer, 64> told;
    for (std::size_t first = 0; first < points.size(); first += told.size()) {
      const std::size_t count = std::min(told.size(), points.size() - first);
      spm_query_batch(asset_.get(), points[first].data(), count, told.data());
      for (std::size_t i = 0; i < count; ++i) answers[first + i] = answer_of(told[i]);
    }
  }
};

/// During its lifetime Highway runs its generic code, which handles one number at a time.
class ScalarTarget {
 public:
  explicit ScalarTarget(std::int64_t usual) : usual_(usual) {
    hwy::GetChosenTarget().Update(HWY_STATIC_TARGET);
  }
  ~ScalarTarget() { hwy::GetChosenTarget().Update(usual_); }
  ScalarTarget(const ScalarTarget&) = delete;
  ScalarTarget& operator=(const ScalarTarget&) = delete;

 private:
  std::int64_t usual_;
};

/// One point per call, and one unit of a list after the other.
class SpmScalar final : public Spm {
 public:
  SpmScalar(const BakedFile& file, QueryAsset asset)
      : Spm(file, std::move(asset)), usual_(hwy::SupportedTargets()) {
    facts_.name = "spm-scalar";
  }

  void query_all(std::span<const Vector3> points,
                 std::span<Answer> answers) const noexcept override {
    // Switch once per block, since each switch affects all threads.
    const ScalarTarget scalar(usual_);
    Spm::query_all(points, answers);
  }

 private:
  std::int64_t usual_;
};

}  // namespace

std::unique_ptr<Method> make_spm(const BakedFile& file, QueryAsset asset) {
  return std::make_unique<Spm>(file, std::move(asset));
}

std::unique_ptr<Method> make_spm_batch(const BakedFile& file, QueryAsset asset) {
  return std::make_unique<SpmBatch>(file, std::move(asset));
}

std::unique_ptr<Method> make_spm_scalar(const BakedFile& file, QueryAsset asset) {
  return std::make_unique<SpmScalar>(file, std::move(asset));
}

}  // namespace spm::bench
