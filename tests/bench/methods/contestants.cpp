// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/methods/contestants.hpp"

namespace spm::bench {
namespace {

class OfMethod final : public Contestant {
 public:
  explicit OfMethod(const Method& method) : method_(method) {}

  void begin(std::span<const TimedPlace> block) override {
    points_.clear();
    for (const TimedPlace& place : block) points_.push_back(place.point);
    answers_.resize(points_.size());
  }

  void ask(std::span<const TimedPlace>) override {
    method_.query_all(points_, answers_);
    keep(*answers_.data());
  }

 private:
  const Method& method_;
  std::vector<Vector3> points_;
  std::vector<Answer> answers_;
};

class OfProbe final : public Contestant {
 public:
  explicit OfProbe(ProbeMethod& method) : method_(method) {}

  void begin(std::span<const TimedPlace>) override {}

  void ask(std::span<const TimedPlace> block) override {
    double sum = 0;
    for (const TimedPlace& place : block) sum += method_.depth(place.point);
    keep(sum);
  }

 private:
  ProbeMethod& method_;
};

class OfProxy final : public Contestant {
 public:
  explicit OfProxy(MeshProxy& proxy) : proxy_(proxy) {}

  void begin(std::span<const TimedPlace> block) override {
    proxy_.place(block.front().free);
    proxy_.follow(block.front().point);
  }

  void go_on(std::span<const TimedPlace>) override {}

  void ask(std::span<const TimedPlace> block) override {
    double sum = 0;
    for (const TimedPlace& place : block) {
      if (place.fresh) proxy_.place(place.free);
      sum += proxy_.follow(place.point).depth;
    }
    keep(sum);
  }

 private:
  MeshProxy& proxy_;
};

}  // namespace

std::unique_ptr<Contestant> contestant_of(const Method& method) {
  return std::make_unique<OfMethod>(method);
}

std::unique_ptr<Contestant> contestant_of(ProbeMethod& method) {
  return std::make_unique<OfProbe>(method);
}

std::unique_ptr<Contestant> contestant_of(MeshProxy& proxy) {
  return std::make_unique<OfProxy>(proxy);
}

}  // namespace spm::bench
