// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <limits>

#include "common/contact/force_law.hpp"
#include "common/query/query.hpp"
#include "formats/asset/asset_writer.hpp"
#include "formats/asset/mapped_asset.hpp"
#include "tests/formats/query/c_client.h"
#include "tests/formats/support/synthetic_asset.hpp"

namespace c_library_test {

namespace {

using namespace spm;
using namespace spm::test;

/// An asset opened by the C library and by C++.
struct Both {
  TemporaryFolder folder;
  std::string path = folder.path("a.spm.exr");
  spm_query_asset* c = nullptr;
  std::unique_ptr<MappedAsset> cpp;

  explicit Both(const Asset& asset) {
    REQUIRE(write_asset(asset, path).has_value());
    std::array<char, 200> message{};
    REQUIRE(c_client_open(path.c_str(), &c, message.data(), message.size()) == 0);
    REQUIRE(c != nullptr);
    CHECK(std::strlen(message.data()) == 0);
    auto opened = MappedAsset::open(path);
    REQUIRE(opened.has_value());
    cpp = std::move(*opened);
  }
  Both(const Both&) = delete;
  Both& operator=(const Both&) = delete;
  ~Both() { spm_query_close(c); }
};

/// The sparse asset's probe is a sphere, so that spheres up to it are allowed.
Asset with_probe(Asset asset, double radius) {
  asset.metadata.probe_radius = radius;
  return asset;
}

std::vector<Vector3> points() {
  std::vector<Vector3> found;
  Random random(1);
  for (int k = 0; k < 5000; ++k) {
    found.emplace_back(random.between(-0.04, 0.04), random.between(-0.04, 0.04),
                       random.between(-0.03, 0.03));
  }
  found.emplace_back(std::nan(""), 0, 0);
  found.emplace_back(0, std::numeric_limits<double>::infinity(), 0);
  return found;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

TEST_CASE("The C library answers as C++ does, at every point and in a batch") {
  for (const Asset& asset : {sparse_asset(1), full_asset(2, {2, 1, 12, 2})}) {
    const Both both(asset);
    std::vector<double> flat;
    std::vector<spm_query_answer> single;
    int exact = 0;
    for (const Vector3& point : points()) {
      const Answer wanted = query_point(both.cpp->view(), point);
      const spm_query_answer answer = c_client_point(both.c, point.x(), point.y(), point.z());
      REQUIRE(same(answer.distance, wanted.distance));
      for (int axis = 0; axis < 3; ++axis) {
        REQUIRE(same(answer.normal[axis], wanted.normal[axis]));
        flat.push_back(point[axis]);
      }
      REQUIRE(answer.plane == wanted.plane);
      REQUIRE(answer.layer == wanted.layer);
      REQUIRE(answer.source == static_cast<int>(wanted.source));
      REQUIRE(answer.status == static_cast<int>(wanted.status));
      exact += answer.status == SPM_QUERY_EXACT ? 1 : 0;
      single.push_back(answer);
    }
    CHECK(exact > 0);
    std::vector<spm_query_answer> batch(single.size());
    spm_query_batch(both.c, flat.data(), batch.size(), batch.data());
    CHECK(std::memcmp(batch.data(), single.data(), batch.size() * sizeof(spm_query_answer)) == 0);
  }
}

TEST_CASE("The memory that answers may come from is the file and the tables that opening adds") {
  for (const Asset& asset : {sparse_asset(1), full_asset(2, {2, 1, 12, 2})}) {
    const Both both(asset);
    const std::size_t memory = spm_query_memory(both.c);
    CHECK(memory == both.cpp->resident_bytes());
    const std::size_t file = std::filesystem::file_size(both.path);
    CHECK(memory >= file + asset.planes.size() * sizeof(SupportPlane));
    CHECK(memory <= file + file / 4);
  }
}

TEST_CASE("The C library's force is that of the force law") {
  const Both sparse(with_probe(sparse_asset(1), 0.0004));
  const Both full(full_asset(2, {2, 1, 12, 2}));
  int contacts = 0;
  const auto compare = [&contacts](const Both& both, int method, double radius) {
    ForceSettings settings;
    settings.method = method == SPM_QUERY_METHOD_PAPER ? Method::paper : Method::spm;
    settings.stiffness = 800;
    settings.probe_radius = radius;
    for (const Vector3& point : points()) {
      const ContactForce wanted = contact_force(both.cpp->view(), settings, point);
      spm_query_contact contact{};
      REQUIRE(c_client_force(both.c, 800, radius, method, point.data(), &contact) == 0);
      for (int axis = 0; axis < 3; ++axis) {
        REQUIRE(contact.force[axis] == wanted.force[axis]);
        REQUIRE(same(contact.normal[axis], wanted.normal[axis]));
      }
      REQUIRE(contact.depth == wanted.depth);
      REQUIRE((contact.contact != 0) == wanted.contact);
      REQUIRE((contact.deep != 0) == wanted.deep);
      contacts += contact.contact;
    }
  };
  compare(sparse, SPM_QUERY_METHOD_SPM, 0);
  compare(sparse, SPM_QUERY_METHOD_SPM, 0.0004);
  compare(full, SPM_QUERY_METHOD_SPM, 0);
  compare(full, SPM_QUERY_METHOD_PAPER, 0);
  CHECK(contacts > 0);
}

TEST_CASE("A ball and a capsule by the paper are felt through C as by the force law") {
  const Both both(with_probe(full_asset(2, {2, 1, 12, 2}), 0.004));
  struct Case {
    double length;
    Vector3 axis;
    int form;
  };
  int contacts = 0;
  for (const Case& felt : {Case{0, Vector3::Zero(), SPM_QUERY_FORM_SURFACE},
                           Case{0, Vector3::Zero(), SPM_QUERY_FORM_VOLUME},
                           Case{0.01, Vector3::Zero(), SPM_QUERY_FORM_SURFACE},
                           Case{0.01, Vector3(2e-200, 0, 0), SPM_QUERY_FORM_SURFACE},
                           Case{0.01, Vector3(0, 3e300, 4e300), SPM_QUERY_FORM_VOLUME}}) {
    ForceSettings settings;
    settings.method = Method::paper;
    settings.stiffness = 800;
    settings.take_probe(
        {felt.length > 0 ? ProbeKind::capsule : ProbeKind::ball, 0.004, felt.length});
    if (felt.form == SPM_QUERY_FORM_VOLUME) settings.form = PaperProbeForm::volume;
    if (!felt.axis.isZero(0)) settings.probe_axis = felt.axis / felt.axis.stableNorm();
    for (const Vector3& point : points()) {
      const ContactForce wanted = contact_force(both.cpp->view(), settings, point);
      spm_query_contact contact{};
      REQUIRE(c_client_probe_force(both.c, 0.004, felt.length, felt.axis.data(), felt.form,
                                   point.data(), &contact) == 0);
      for (int axis = 0; axis < 3; ++axis) REQUIRE(contact.force[axis] == wanted.force[axis]);
      REQUIRE(contact.depth == wanted.depth);
      REQUIRE((contact.contact != 0) == wanted.contact);
      contacts += contact.contact;
      if (felt.length > 0 || felt.form != SPM_QUERY_FORM_SURFACE) continue;
      // The method of version 1 is the same on a ball, and does not read what it did not have.
      spm_query_force_settings old;
      std::memset(&old, 0x5a, sizeof old);
      old.stiffness = 800;
      old.probe_radius = 0.004;
      old.method = SPM_QUERY_METHOD_PAPER;
      spm_query_contact same_contact{};
      REQUIRE(spm_query_force(both.c, &old, point.data(), &same_contact) == 0);
      REQUIRE(std::memcmp(&same_contact, &contact, sizeof contact) == 0);
    }
  }
  CHECK(contacts > 100);
}

TEST_CASE("A probe out of range is refused with no force") {
  const Both full(with_probe(full_asset(2, {2, 1, 12, 2}), 0.0004));
  const double nan = std::nan("");
  struct Case {
    double radius, length, axis;
    int form;
  };
  for (const Case& wrong : {Case{0.0004, -0.01, 1, 0}, Case{0.0004, nan, 1, 0}, Case{0, 0.01, 1, 0},
                            Case{0.0005, 0.01, 1, 0}, Case{0.0004, 0.01, nan, 0},
                            Case{0.0004, 0.01, 1, 2}, Case{0, 0, 1, SPM_QUERY_FORM_VOLUME},
                            Case{0.0004, std::numeric_limits<double>::infinity(), 1, 0}}) {
    const std::array<double, 3> point{0.01, 0.01, 0.01}, axis{0, 0, wrong.axis};
    spm_query_contact contact;
    std::memset(&contact, 0x5a, sizeof contact);
    CHECK(c_client_probe_force(full.c, wrong.radius, wrong.length, axis.data(), wrong.form,
                               point.data(), &contact) == 1);
    CHECK(contact.force[0] == 0);
    CHECK(contact.contact == 0);
  }
}

TEST_CASE("What version 1 of the settings had is where it was") {
  CHECK(offsetof(spm_query_force_settings, stiffness) == 0);
  CHECK(offsetof(spm_query_force_settings, probe_radius) == 8);
  CHECK(offsetof(spm_query_force_settings, method) == 16);
  CHECK(sizeof(spm_query_force_settings) == 64);
}

TEST_CASE("Force settings out of range are refused with no force") {
  const Both sparse(with_probe(sparse_asset(1), 0.0004));
  const Both full(with_probe(full_asset(2, {2, 1, 12, 2}), 0.0004));
  struct Case {
    const Both* both;
    double stiffness, radius;
    int method;
  };
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Case& wrong :
       {Case{&sparse, -1, 0, SPM_QUERY_METHOD_SPM}, Case{&sparse, nan, 0, SPM_QUERY_METHOD_SPM},
        Case{&sparse, infinity, 0, SPM_QUERY_METHOD_SPM},
        Case{&sparse, 1, -0.001, SPM_QUERY_METHOD_SPM}, Case{&sparse, 1, nan, SPM_QUERY_METHOD_SPM},
        Case{&sparse, 1, 0.0005, SPM_QUERY_METHOD_SPM}, Case{&sparse, 1, 0, SPM_QUERY_METHOD_PAPER},
        Case{&sparse, 1, 0, SPM_QUERY_METHOD_PAPER_PROBE}, Case{&full, 1, 0, 3},
        Case{&full, 1, 0.0005, SPM_QUERY_METHOD_PAPER}}) {
    const std::array<double, 3> point{0.01, 0.01, 0.01};
    spm_query_contact contact;
    std::memset(&contact, 0x5a, sizeof contact);
    CHECK(c_client_force(wrong.both->c, wrong.stiffness, wrong.radius, wrong.method, point.data(),
                         &contact) == 1);
    CHECK(contact.force[0] == 0);
    CHECK(contact.depth == 0);
    CHECK(contact.contact == 0);
  }
}

TEST_CASE("The C library tells band and box") {
  const Both both(sparse_asset(1));
  double max_depth = 0, margin = 0;
  std::array<double, 3> box_min{}, box_max{};
  spm_query_band(both.c, &max_depth, &margin);
  spm_query_box(both.c, box_min.data(), box_max.data());
  CHECK(max_depth == 0.002);
  CHECK(margin == 0.0005);
  CHECK(box_min == std::array{-0.03, -0.03, -0.02});
  CHECK(box_max == std::array{0.03, 0.03, 0.02});
  CHECK(spm_query_lost(both.c) == 0);
}

TEST_CASE("The C library's errors carry the exit code and a message that fits its buffer") {
  const TemporaryFolder folder;
  const std::string missing = folder.path("missing.spm.exr");
  write_bytes(folder.path("text.exr"), "no asset");
  spm_query_asset* asset = nullptr;
  std::array<char, 300> message{};
  CHECK(c_client_open(missing.c_str(), &asset, message.data(), message.size()) == 2);
  CHECK(asset == nullptr);
  CHECK(std::string(message.data()).find(missing) == 0);
  CHECK(c_client_open(folder.path("text.exr").c_str(), &asset, message.data(), message.size()) ==
        3);

  message.fill('x');
  CHECK(c_client_open(missing.c_str(), &asset, message.data(), 10) == 2);
  CHECK(std::string(message.data()) == missing.substr(0, 9));
  CHECK(message[10] == 'x');
  CHECK(c_client_open(missing.c_str(), &asset, nullptr, 0) == 2);
  CHECK(c_client_open(missing.c_str(), &asset, message.data(), 0) == 2);
  CHECK(c_client_open(nullptr, &asset, message.data(), message.size()) == 1);
  CHECK(c_client_open(missing.c_str(), nullptr, message.data(), message.size()) == 1);
  spm_query_close(nullptr);
}

TEST_CASE("An asset that is truncated while the C library maps it is told as lost") {
  const Both both(sparse_asset(1));
  std::filesystem::resize_file(both.path, 1);
  for (const Vector3& point : points()) {
    c_client_point(both.c, point.x(), point.y(), point.z());
  }
  CHECK(spm_query_lost(both.c) == 1);
}

}  // namespace c_library_test
