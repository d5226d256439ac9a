// SPDX-License-Identifier: Apache-2.0
#include "formats/files/json_text.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <string>

#include "formats/files/json_fields.hpp"

namespace json_text_test {

using namespace spm;
using Json = JsonFields::Json;

namespace {

std::string nested(int levels) { return std::string(levels, '[') + std::string(levels, ']'); }

}  // namespace

TEST_CASE("JSON is read to 64 levels and refused beyond, before anything is parsed") {
  CHECK(parse_json<Json>(nested(most_json_levels)).is_array());
  CHECK(parse_json<Json>(nested(most_json_levels + 1)).is_discarded());
  CHECK(parse_json<Json>(std::string(10'000'000, '[')).is_discarded());
  CHECK(parse_json<Json>(R"({"a":)" + nested(200'000) + "}").is_discarded());
}

TEST_CASE("Brackets that follow each other or stand in a string nest nothing") {
  std::string wide = "[";
  for (int i = 0; i < 1000; ++i) wide += "[],{},";
  CHECK(parse_json<Json>(wide + "0]").is_array());
  CHECK(parse_json<Json>('"' + std::string(1000, '[') + R"(\"{\\)" + '"').is_string());
  CHECK(parse_json<Json>(R"(["\\",)" + nested(most_json_levels - 1) + "]").is_array());
  CHECK(parse_json<Json>(R"(["\\",)" + nested(most_json_levels) + "]").is_discarded());
}

TEST_CASE("JSON that is broken, or has a number beyond all doubles, is discarded") {
  for (const char* text : {"", "{", "]", "[1e999]", "\"\\", "nul", "{}x"}) {
    CAPTURE(text);
    CHECK(parse_json<Json>(text).is_discarded());
  }
}

TEST_CASE("A number of a file that has no bounds of its own lies within 1e12") {
  for (const double value : {1.1e12, -1.1e12, std::numeric_limits<double>::max(), 1e154}) {
    const Json json = {{"a", value}, {"b", {0, 0, value}}};
    std::string problem, other;
    CHECK(JsonFields(json, "", problem).number("a") == 0);
    CHECK(problem == "`a` is not a number from -1000000000000.0 to 1000000000000.0");
    CHECK(JsonFields(json, "", other).vector("b") == Vector3::Zero());
    CHECK(other.starts_with("`b` is not an array of three numbers from -1"));
  }
  const Json json = {{"a", 1e12}, {"b", {0, -1e12, 1}}};
  std::string problem;
  JsonFields fields(json, "", problem);
  CHECK(fields.number("a") == 1e12);
  CHECK(fields.vector("b") == Vector3(0, -1e12, 1));
  CHECK(problem.empty());
}

}  // namespace json_text_test
