// SPDX-License-Identifier: Apache-2.0
#include "common/paper/probe_shape.hpp"

#include <catch2/catch.hpp>

namespace spm::probe_shape_test {
namespace {

TEST_CASE("A probe is written as a point, a sphere or a capsule, and read back the same") {
  struct Case {
    const char* text;
    ProbeShape shape;
  };
  for (const Case& right : {Case{"point", {}}, Case{"sphere:0.5mm", {ProbeKind::ball, 5e-4, 0}},
                            Case{"capsule:0.5mm,1cm", {ProbeKind::capsule, 5e-4, 0.01}},
                            Case{"capsule:200um, 10 mm", {ProbeKind::capsule, 2e-4, 0.01}}}) {
    INFO(right.text);
    const auto shape = parse_probe_shape(right.text);
    REQUIRE(shape);
    CHECK(*shape == right.shape);
    CHECK(parse_probe_shape(text_of(*shape)) == right.shape);
  }
}

TEST_CASE("What is no probe is refused with what to write instead") {
  struct Case {
    const char *text, *cure;
  };
  for (const Case& wrong :
       {Case{"", "write point, sphere:RADIUS such as sphere:0.5mm or capsule:RADIUS,LENGTH"},
        Case{"Point", "write point"},
        Case{"sphere", "write point"},
        Case{"cube:1mm", "sphere:RADIUS"},
        Case{"sphere:", "number"},
        Case{"sphere:1", "unit"},
        Case{"sphere:0mm", "above 0"},
        Case{"sphere:-1mm", "above 0"},
        Case{"sphere:nanmm", "finite"},
        Case{"sphere:1mm,2mm", "write sphere:RADIUS"},
        Case{"capsule:1mm", "write capsule:RADIUS,LENGTH"},
        Case{"capsule:1mm,", "number"},
        Case{"capsule:,5mm", "number"},
        Case{"capsule:1mm,0mm", "above 0"},
        Case{"capsule:0mm,1mm", "above 0"},
        Case{"capsule:-1mm,5mm", "above 0"},
        Case{"capsule:1mm,-5mm", "above 0"},
        Case{"capsule:1mm,5", "unit"},
        Case{"capsule:1mm,5mm,6mm", "5mm,6mm"},
        Case{"capsule", "write point"}}) {
    INFO(wrong.text);
    const auto refused = parse_probe_shape(wrong.text);
    REQUIRE_FALSE(refused);
    INFO(refused.error().message);
    CHECK(refused.error().code == ExitCode::usage);
    CHECK(refused.error().message.find("'" + std::string(wrong.text) + "'") == 0);
    CHECK(refused.error().message.find(wrong.cure) != std::string::npos);
  }
}

TEST_CASE("A capsule is as long as its length and its two ends, along the axis that is given") {
  const ProbeShape shape{ProbeKind::capsule, 1e-3, 6e-3};
  const Vector3 centre(0.1, 0.2, 0.3), axis = Vector3(1, 2, 2) / 3;
  const auto span_along = [&](const Vector3& direction) {
    return with_probe(shape, centre, axis,
                      [&](const ImplicitProbe& probe) { return probe.span(centre, direction); });
  };
  CHECK(span_along(axis).far == Approx(4e-3));
  CHECK(span_along(axis).near == Approx(-4e-3));
  CHECK(span_along(Vector3(2, -2, 1) / 3).far == Approx(1e-3));
}

}  // namespace
}  // namespace spm::probe_shape_test
