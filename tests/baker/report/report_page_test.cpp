// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/report_page.hpp"

#include <catch2/catch.hpp>

#include "baker/base/bake_error.hpp"
#include "baker/verify/outcome.hpp"

namespace report_page_test {

using namespace spm;
using namespace spm::baker;
using Json = nlohmann::ordered_json;

TEST_CASE("Bytes are written in base64 as RFC 4648 says") {
  CHECK(base64("") == "");
  CHECK(base64("f") == "Zg==");
  CHECK(base64("foobar") == "Zm9vYmFy");
  CHECK(base64(std::string("\xff\0", 2)) == "/wA=");
}

TEST_CASE(
    "Data stands in the page in the place that is kept for it, and no text ends its element") {
  const std::string page = R"(<script id="data">"SPM_REPORT_DATA"</script><b>)";
  const std::string text = filled_page(page, Json{{"name", "</script><script>alert(1)</script>"}});
  CHECK(text.find("alert") != std::string::npos);
  CHECK(text.find("</script><script>") == std::string::npos);
  const std::size_t from = text.find('{'), to = text.rfind('}');
  const Json read = Json::parse(text.substr(from, to + 1 - from));
  CHECK(read["name"] == "</script><script>alert(1)</script>");
  CHECK(text.substr(to + 1) == "</script><b>");
}

TEST_CASE("A name that is no UTF-8 does not keep the page from being written") {
  const std::string text = filled_page(R"("SPM_REPORT_DATA")", Json{{"name", "a\xff"}});
  CHECK(Json::accept(text));
}

TEST_CASE("Errors are counted by their size, and those beyond the threshold apart") {
  constexpr double threshold = 5e-5;
  std::vector<Outcome> outcomes;
  for (const double share : {0.0, 0.01, 0.99, 1.0, 1.5}) {
    Outcome outcome;
    outcome.drawn = outcome.answered = true;
    outcome.error = share * threshold;
    outcomes.push_back(outcome);
  }
  outcomes.emplace_back().drawn = true;  // without an answer
  const VerifyReport report = report_of(outcomes, threshold);
  REQUIRE(report.histogram.size() == histogram_bins + 1);
  CHECK(report.histogram.front() == 2);
  CHECK(report.histogram[histogram_bins - 1] == 2);
  CHECK(report.histogram.back() == 1);
}

TEST_CASE("A page without a place for data is a bug that is told") {
  CHECK_THROWS_AS(filled_page("<p>", Json{}), BakeError);
}

}  // namespace report_page_test
