// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/batch/result_file.hpp"

#include <nlohmann/json.hpp>

#include "formats/files/json_text.hpp"
#include "formats/files/output_file.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* version_key = "spm_batch_result";
constexpr int version = 1;

AssetResult asset_of(const Json& json) {
  AssetResult asset;
  asset.name = json.at("name").get<std::string>();
  asset.output = json.at("output").get<std::string>();
  asset.begun = json.at("begun").get<bool>();
  asset.code = static_cast<ExitCode>(json.at("exit_code").get<int>());
  asset.error = json.at("error").get<std::string>();
  asset.sha256 = json.at("content_sha256").get<std::string>();
  return asset;
}

}  // namespace

BatchResult result_of(const Manifest& part, const Shard& shard,
                      const std::vector<AssetOutcome>& outcomes) {
  BatchResult result{part.sha256, shard, {}};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    AssetResult asset;
    asset.name = part.entries[i].name;
    asset.output = part.entries[i].output;
    asset.begun = outcomes[i].known;
    asset.code = outcomes[i].code;
    asset.error = outcomes[i].error;
    if (outcomes[i].ok()) asset.sha256 = outcomes[i].report.value("content_sha256", "");
    result.assets.push_back(std::move(asset));
  }
  return result;
}

Result<void> write_result(const std::string& path, const BatchResult& result) {
  Json json;
  json[version_key] = version;
  json["manifest_sha256"] = result.manifest_sha256;
  json["shard"] = {{"index", result.shard.index}, {"count", result.shard.count}};
  json["assets"] = Json::array();
  for (const AssetResult& asset : result.assets) {
    json["assets"].push_back({{"name", asset.name},
                              {"output", asset.output},
                              {"begun", asset.begun},
                              {"exit_code", static_cast<int>(asset.code)},
                              {"error", asset.error},
                              {"content_sha256", asset.sha256}});
  }
  return write_file(path, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<BatchResult> read_result(const std::string& path) {
  const Result<std::string> text = read_text_file(path, "a file of --result");
  if (!text) return tl::make_unexpected(text.error());
  const Json json = parse_json<Json>(*text);
  if (!json.is_object() || json.value(version_key, Json()) != version) {
    return fail(ExitCode::invalid_input,
                path + ": is no result of a batch of this version; give files of --result");
  }
  try {
    BatchResult result;
    result.manifest_sha256 = json.at("manifest_sha256").get<std::string>();
    result.shard.index = json.at("shard").at("index").get<unsigned>();
    result.shard.count = json.at("shard").at("count").get<unsigned>();
    for (const Json& asset : json.at("assets")) result.assets.push_back(asset_of(asset));
    return result;
  } catch (const Json::exception& problem) {
    return fail(ExitCode::invalid_input,
                path + ": is incomplete: " + problem.what() + "; run its shard again");
  }
}

}  // namespace spm::baker
