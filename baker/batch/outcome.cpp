// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/outcome.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstring>
#include <new>

#include "baker/base/bake_error.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t start = text.rfind('\n');
  if (start != std::string::npos) text.erase(0, start + 1);
  constexpr std::string_view mark = "error: ";
  if (text.starts_with(mark)) text.erase(0, mark.size());
  return text;
}

}  // namespace

AssetOutcome failed_outcome(Error error) {
  AssetOutcome outcome;
  outcome.known = true;
  outcome.code = error.code;
  outcome.error = std::move(error.message);
  return outcome;
}

AssetOutcome built_outcome(const Cache* cache, const BuildRequest& request,
                           const Progress& progress) {
  try {
    BuildReport report = build_through(cache, request, progress);
    AssetOutcome outcome;
    outcome.known = true;
    outcome.report = std::move(report.json);
    outcome.warnings = std::move(report.warnings);
    return outcome;
  } catch (const BakeError& error) {
    return failed_outcome({error.code(), error.what()});
  } catch (const std::bad_alloc&) {
    return failed_outcome(
        {ExitCode::internal, request.mesh + ": out of memory; bake with a larger tolerance"});
  } catch (const std::exception& error) {
    return failed_outcome({ExitCode::internal, request.mesh + ": " + error.what()});
  }
}

std::string encoded(const AssetOutcome& outcome) {
  const Json json = {{"code", static_cast<int>(outcome.code)},
                     {"error", outcome.error},
                     {"report", outcome.report},
                     {"warnings", outcome.warnings}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

AssetOutcome outcome_of(const JobEvent& end, const BuildRequest& request) {
  const Json json = Json::parse(end.answer, nullptr, false);
  if (json.is_object()) {
    AssetOutcome outcome;
    outcome.known = true;
    outcome.code = static_cast<ExitCode>(json["code"].get<int>());
    outcome.error = json["error"].get<std::string>();
    outcome.report = json["report"];
    outcome.warnings = json["warnings"].get<std::vector<std::string>>();
    return outcome;
  }
  if (WIFSIGNALED(end.wait_status)) {
    const int number = WTERMSIG(end.wait_status);
    return failed_outcome(
        {ExitCode::internal,
         fmt::format("{}: its bake was ended by signal {} ({}); where memory ran out, bake with a "
                     "larger tolerance or a smaller -j",
                     request.mesh, number, ::strsignal(number))});
  }
  const std::string said = last_line(end.errors);
  const int code = WEXITSTATUS(end.wait_status);
  return failed_outcome(
      {code == 0 ? ExitCode::internal : static_cast<ExitCode>(code),
       said.empty() ? request.mesh + ": its bake ended without an answer" : said});
}

Json line_of(const std::string& name, const AssetOutcome& outcome) {
  Json line;
  line["name"] = name;
  line["ok"] = outcome.ok();
  line["error"] = outcome.ok() ? Json() : Json(outcome.error);
  line["exit_code"] = static_cast<int>(outcome.code);
  if (outcome.report.is_object()) line.update(outcome.report);
  return line;
}

}  // namespace spm::baker
