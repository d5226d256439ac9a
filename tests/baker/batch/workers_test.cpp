// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/workers.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <iostream>
#include <map>

#include "baker/batch/batch.hpp"
#include "baker/batch/outcome.hpp"

namespace spm::baker::workers_test {
namespace {

/// Runs jobs at once until all have ended.
std::map<std::size_t, JobEvent> ends_of(const std::vector<Job>& jobs) {
  Workers workers;
  for (std::size_t i = 0; i < jobs.size(); ++i) REQUIRE(workers.start(i, jobs[i]));
  std::map<std::size_t, JobEvent> ends;
  while (workers.running() > 0) {
    JobEvent event = workers.wait();
    if (event.ended) ends.emplace(event.job, std::move(event));
  }
  return ends;
}

BuildRequest request_of(const std::string& mesh) {
  BuildRequest request;
  request.mesh = mesh;
  return request;
}

}  // namespace

TEST_CASE("Jobs run in processes of their own and give their answers") {
  const auto job = [](const Progress&) { return std::to_string(::getpid()); };
  const auto ends = ends_of({job, job});
  CHECK_FALSE(ends.at(0).answer.empty());
  CHECK(ends.at(0).answer != ends.at(1).answer);
  CHECK(ends.at(0).answer != std::to_string(::getpid()));
}

TEST_CASE("A long answer arrives whole") {
  const std::string text(3'000'000, 'x');
  CHECK(ends_of({[&](const Progress&) { return text; }}).at(0).answer == text);
}

TEST_CASE("A job tells how far it is") {
  Workers workers;
  REQUIRE(workers.start(7, [](const Progress& progress) {
    progress("cast", 0.25);
    return std::string("done");
  }));
  const JobEvent event = workers.wait();
  CHECK(event.job == 7);
  CHECK_FALSE(event.ended);
  CHECK(event.stage == "cast");
  CHECK(event.done == Approx(0.25));
  CHECK(workers.wait().ended);
}

TEST_CASE("A job that is killed takes no other with it, and its outcome says so") {
  const auto ends = ends_of({[](const Progress&) -> std::string {
                               ::raise(SIGKILL);
                               return "never";
                             },
                             [](const Progress&) { return std::string("fine"); }});
  CHECK(ends.at(1).answer == "fine");
  const AssetOutcome outcome = outcome_of(ends.at(0), request_of("teeth.obj"));
  CHECK(outcome.known);
  CHECK(outcome.code == ExitCode::internal);
  CHECK_THAT(outcome.error, Catch::StartsWith("teeth.obj: ") && Catch::Contains("signal 9"));
}

TEST_CASE("A job that ends with a code and a sentence fails with these") {
  const auto ends = ends_of({[](const Progress&) -> std::string {
    std::cerr << "something before\nerror: out.exr: the time limit is reached" << std::endl;
    ::_exit(10);
  }});
  const AssetOutcome outcome = outcome_of(ends.at(0), request_of("teeth.obj"));
  CHECK(outcome.code == ExitCode::tolerance_not_met);
  CHECK(outcome.error == "out.exr: the time limit is reached");
}

TEST_CASE("An outcome survives the way between processes") {
  AssetOutcome outcome;
  outcome.known = true;
  outcome.code = ExitCode::invalid_input;
  outcome.error = "a line\nand another \xff";
  outcome.report = {{"bytes", 12}};
  outcome.warnings = {"one", "two"};
  JobEvent end;
  end.answer = encoded(outcome);
  CHECK(end.answer.find('\n') == std::string::npos);
  const AssetOutcome back = outcome_of(end, {});
  CHECK(back.code == outcome.code);
  CHECK_THAT(back.error, Catch::StartsWith("a line\nand another "));
  CHECK(back.report == outcome.report);
  CHECK(back.warnings == outcome.warnings);
}

TEST_CASE("Threads are shared out so that the cores are busy and not more") {
  CHECK(thread_share(8, 4) == 2);
  CHECK(thread_share(8, 3) == 2);
  CHECK(thread_share(2, 2) == 1);
  CHECK(thread_share(1, 4) == 1);
  CHECK(thread_share(0, 1) == 1);
  CHECK(thread_share(16, 1) == 16);
}

}  // namespace spm::baker::workers_test
