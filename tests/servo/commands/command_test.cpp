// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/asset/mapped_asset.hpp"
#include "servo/base/clock.hpp"
#include "servo/devices/finder/device_list.hpp"
#include "tests/servo/support/servo_program.hpp"
#include "tests/support/skip.hpp"

namespace command_test {

using nlohmann::json;

namespace {

std::vector<std::string> words(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> list;
  for (std::string word; stream >> word;) list.push_back(word);
  return list;
}

}  // namespace

TEST_CASE("A run reports everything that the contract names, and nothing else on stdout") {
  const Workshop shop;
  const Outcome run =
      servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "1.5", "--json"});
  REQUIRE(run.code == 0);
  const json report = json::parse(run.out);
  REQUIRE(report["ticks"].get<int>() + report["skipped"].get<int>() >= 1500);
  REQUIRE(report["contact_ticks"].get<double>() >= 0.6 * report["ticks"].get<double>());
  REQUIRE(report["rate_hz"] == 1000);
  for (const char* key : {"wake_us", "busy_us"}) {
    REQUIRE(report[key]["p50"] <= report[key]["p99"]);
    REQUIRE(report[key]["p99"] <= report[key]["p999"]);
    REQUIRE(report[key]["p999"] <= report[key]["max"]);
  }
  for (const char* key : {"missed", "page_faults"}) REQUIRE(report[key].is_number_integer());
  REQUIRE(report["realtime"].contains("policy"));
  REQUIRE(report["realtime"].contains("priority"));
  REQUIRE(report["realtime"]["memory_locked"].is_boolean());
  REQUIRE(report["force_off"].is_array());
  REQUIRE(report["force_n"]["max"].get<double>() > 0.1);
  REQUIRE(report["force_n"]["cap_hits"] == 0);
  REQUIRE(report["energy_j"]["generated_max"].is_number());
  REQUIRE(report["devices"][0]["name"] == "sim");
  REQUIRE(report["assets"][0]["form"] == "sparse");
  CHECK(report["assets"][0]["open_seconds"] > 0);
  const std::uint64_t bytes = report["assets"][0]["bytes"];
  const auto asset = spm::MappedAsset::open(shop.sparse);
  REQUIRE(asset.has_value());
  CHECK(report["assets"][0]["resident_bytes"] == (*asset)->resident_bytes());
  CHECK(report["assets"][0]["resident_bytes"] >= bytes);
}

TEST_CASE("A recording of a run replays to forces equal bit by bit, friction and all") {
  const Workshop shop;
  const std::string scene = shop.scene(
      "[[object]]\nasset = \"sparse.spm.exr\"\nfriction = { slide = 0.3, stick = 0.5 }\n"
      "damping = \"1Ns/m\"\ntexture = { amplitude = \"50um\", wavelength = \"2mm\" }\n");
  const std::string recording = shop.folder.file("run.spmrec");
  const Outcome run =
      servo(shop.folder, {"run", "--scene", scene, "--duration", "1", "--json", "--record",
                          recording, "--device", "sim:seed=3", "--device", "sim:hand=push"});
  REQUIRE(run.code == 0);
  for (const char* device : {"0", "1"}) {
    const Outcome replay = servo(shop.folder, {"replay", recording, "--scene", scene, "--out",
                                               shop.out, "--device-number", device, "--json"});
    REQUIRE(replay.code == 0);
    const json report = json::parse(replay.out);
    CHECK(report["recording"]["forces_equal"] == true);
    CHECK(report["recording"]["lost"] == 0);
    CHECK(report["contact_ticks"] ==
          json::parse(run.out)["devices"][std::stoi(device)]["contact_ticks"]);
    CHECK(report["contact_ticks"].get<int>() > 0);
  }
  const Outcome stiffer = servo(shop.folder, {"replay", recording, "--scene", scene, "--stiffness",
                                              "2N/mm", "--out", shop.out, "--json"});
  CHECK(stiffer.code == 10);
  CHECK(json::parse(stiffer.out)["recording"]["forces_equal"] == false);
  const Outcome third = servo(shop.folder, {"replay", recording, "--scene", scene, "--out",
                                            shop.out, "--device-number", "2"});
  CHECK(third.code == 1);
  require_one_sentence(third.err);
}

TEST_CASE(
    "Stabilization by the command line acts, is reported, and a replay with it gives the same") {
  const Workshop shop;
  const std::string recording = shop.folder.file("stabilized.spmrec");
  const Outcome run = servo(
      shop.folder, {"run", "--asset", shop.sparse, "--stabilization", "recommended", "--duration",
                    "1", "--device", "sim:seed=3", "--json", "--record", recording});
  CAPTURE(run.err);
  REQUIRE(run.code == 0);
  const json report = json::parse(run.out);
  CHECK(report["stabilization_settings"]["damping_share"] == 1);
  CHECK(report["stabilization_settings"]["passivity"] == true);
  const auto forces_equal = [&](const char* stabilization) {
    const Outcome replay =
        servo(shop.folder, {"replay", recording, "--asset", shop.sparse, "--stabilization",
                            stabilization, "--out", shop.out, "--json"});
    CAPTURE(stabilization, replay.err);
    const bool equal = json::parse(replay.out)["recording"]["forces_equal"].get<bool>();
    REQUIRE(replay.code == (equal ? 0 : 10));
    return equal;
  };
  CHECK(forces_equal("damping+passivity"));
  CHECK_FALSE(forces_equal("none"));
  // The scene's own stabilizers are overridden.
  const std::string scene =
      shop.scene("[stabilization]\nrecommended = true\n[[object]]\nasset = \"sparse.spm.exr\"\n");
  const auto reported = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"replay", recording, "--scene", scene,
                                   "--out",  shop.out,  "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return json::parse(servo(shop.folder, words).out).contains("stabilization_settings");
  };
  CHECK(reported({}));
  CHECK_FALSE(reported({"--stabilization", "none"}));
}

TEST_CASE("A rate is understood with its unit, and a wrong one is refused with the range") {
  const Workshop shop;
  for (const char* rate : {"1000", "1000Hz", "1kHz", "1 kHz"}) {
    CAPTURE(rate);
    const Outcome run = servo(shop.folder, {"run", "--asset", shop.sparse, "--rate", rate,
                                            "--duration", "0.1", "--device", "sim", "--json"});
    CHECK(run.code == 0);
    CHECK(json::parse(run.out)["rate_hz"] == 1000);
  }
  for (const char* rate : {"1000hz", "1MHz", "10kHz", "nan", "", "kHz", "1000 1000"}) {
    CAPTURE(rate);
    const Outcome run = servo(shop.folder, {"run", "--asset", shop.sparse, "--rate", rate});
    CHECK(run.code == 1);
    require_one_sentence(run.err);
    CHECK(run.err.find("500 to 4000") != std::string::npos);
  }
}

TEST_CASE("An enable switch that the device does not have is refused before the first tick") {
  const Workshop shop;
  const Outcome none = servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "1",
                                           "--device", "sim", "--enable-switch", "button:1"});
  REQUIRE(none.code == 1);
  REQUIRE(none.err.find("--enable-switch button:1: sim has no buttons") != std::string::npos);
  for (const char* wrong : {"button:0", "button:33", "grip", "1", "button:"}) {
    const Outcome refused = servo(
        shop.folder, {"run", "--asset", shop.sparse, "--duration", "1", "--enable-switch", wrong});
    REQUIRE(refused.code == 1);
    REQUIRE(refused.err.find("write button:N") != std::string::npos);
  }
}

TEST_CASE("A run tells how its force comes back, and whether the cores are kept awake") {
  const Workshop shop;
  const Outcome run =
      servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "0.2", "--recovery",
                          "acknowledge", "--realtime", "off", "--device", "sim", "--json"});
  REQUIRE(run.code == 0);
  const json report = json::parse(run.out);
  REQUIRE(report["recovery"] == "acknowledge");
  REQUIRE(report["realtime"]["cpu_dma_latency"]["held"] == false);
  REQUIRE(report["realtime"]["cpu_dma_latency"]["why"] == "real time was not asked for");
}

TEST_CASE("A stiffness that the simulated device does not hold is warned of at the start") {
  const Workshop shop;
  const Outcome run = servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "0.1",
                                          "--device", "sim", "--stiffness", "100N/mm"});
  REQUIRE(run.code == 0);
  REQUIRE(run.err.find("sim: 100 N/mm at the hand is more than the 996 N/m") != std::string::npos);
}

TEST_CASE("Two devices have two lines in the summary, one has none of its own") {
  const Workshop shop;
  const Outcome two =
      servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "0.2", "--device",
                          "sim:seed=3", "--device", "sim:profile=falcon"});
  REQUIRE(two.code == 0);
  CHECK(two.out.find("\ndevice 0 sim: in contact for ") != std::string::npos);
  CHECK(two.out.find("\ndevice 1 sim: in contact for ") != std::string::npos);
  const Outcome one =
      servo(shop.folder, {"run", "--asset", shop.sparse, "--duration", "0.1", "--device", "sim"});
  CHECK(one.out.find("device 0") == std::string::npos);
}

TEST_CASE("An asset of a scene that cannot be opened is told with the scene's file and line") {
  const Workshop shop;
  std::ofstream(shop.folder.file("cut.spm.exr")) << "no asset";
  for (const char* asset : {"missing.spm.exr", "cut.spm.exr"}) {
    const std::string scene =
        shop.scene("[[object]]\nasset = \"sparse.spm.exr\"\n\n[[object]]\nasset = \"" +
                   std::string(asset) + "\"\n");
    for (const char* command : {"run", "replay"}) {
      CAPTURE(asset, command);
      std::vector<std::string> words{command, "--scene", scene};
      if (words[0] == "replay") words.insert(words.end(), {shop.slide, "--out", shop.out});
      const Outcome outcome = servo(shop.folder, words);
      CHECK(outcome.code != 0);
      require_one_sentence(outcome.err);
      CHECK(outcome.err.starts_with("error: " + scene + ": line 4: "));
      CHECK(outcome.err.find(asset) != std::string::npos);
    }
  }
}

TEST_CASE("A run of a scene reports its objects, and holds the scene's cap after the sum") {
  const Workshop shop;
  const std::string scene = shop.scene(
      "[device]\ndriver = \"sim\"\nprofile = \"falcon\"\nforce_cap = \"0.4N\"\n"
      "[workspace]\npose = [0.1, 0, 0]\n"
      "[[object]]\nasset = \"sparse.spm.exr\"\npose = [0.1, 0, 0]\nscale = 2\n"
      "friction = { slide = 0.3 }\ndamping = \"1Ns/m\"\n"
      "[[object]]\nasset = \"full.spm.exr\"\npose = [0.3, 0, 0]\nmethod = \"paper\"\n"
      "[[object]]\nasset = \"sparse.spm.exr\"\npose = [0, 0.3, 0]\nmethod = \"proxy\"\n");
  const Outcome run = servo(shop.folder, {"run", "--scene", scene, "--duration", "1.5", "--json"});
  CAPTURE(run.err);
  REQUIRE(run.code == 0);
  const json report = json::parse(run.out);
  REQUIRE(report["contact_ticks"].get<double>() >= 0.6 * report["ticks"].get<double>());
  REQUIRE(report["scene"] == scene);
  REQUIRE(report["objects"].size() == 3);
  REQUIRE(report["objects"][1]["method"] == "paper");
  REQUIRE(report["assets"].size() == 2);
  REQUIRE(report["devices"][0]["profile"] == "falcon");
  REQUIRE(report["devices"][0]["force_cap_n"] == 0.4);
  REQUIRE(report["force_n"]["max"].get<double>() <= 0.4 * (1 + 1e-12));
  REQUIRE(report["force_n"]["cap_hits"].get<int>() > 0);
}

TEST_CASE("A scene with a profile and no driver takes what is plugged in, or says what it takes") {
  const Workshop shop;
  const std::string scene =
      shop.scene("[device]\nprofile = \"falcon\"\n[[object]]\nasset = \"sparse.spm.exr\"\n");
  const Outcome run = servo(shop.folder, {"run", "--scene", scene, "--duration", "0.2", "--json"});
  if (!spm::servo::first_of(spm::servo::find_devices(), "").empty()) {
    SPM_SKIP("a haptic device is plugged in: what a scene takes without one is not tested");
  }
  REQUIRE(run.code == 0);
  REQUIRE(run.err.find("the simulated one is taken") != std::string::npos);
  REQUIRE(json::parse(run.out)["devices"][0]["name"] == "sim");
  REQUIRE(json::parse(run.out)["devices"][0]["profile"] == "falcon");
}

TEST_CASE("A replay of a scene without effects writes what a replay of its asset writes") {
  const Workshop shop;
  const std::string scene = shop.scene("[[object]]\nasset = \"sparse.spm.exr\"\n");
  const std::string other = shop.folder.file("other.csv");
  REQUIRE(
      servo(shop.folder, {"replay", shop.slide, "--asset", shop.sparse, "--out", shop.out}).code ==
      0);
  const Outcome replay =
      servo(shop.folder, {"replay", shop.slide, "--scene", scene, "--out", other, "--json"});
  REQUIRE(replay.code == 0);
  REQUIRE(json::parse(replay.out)["assets"][0]["form"] == "sparse");
  REQUIRE(content(other) == content(shop.out));
}

TEST_CASE("A run traces one row a tick") {
  const Workshop shop;
  const Outcome run = servo(shop.folder, {"run", "--asset", shop.full, "--duration", "0.5",
                                          "--trace", shop.out, "--json"});
  REQUIRE(run.code == 0);
  const std::string trace = content(shop.out);
  const auto lines = std::count(trace.begin(), trace.end(), '\n');
  REQUIRE(lines == json::parse(run.out)["ticks"].get<int>() + 1);
  REQUIRE(trace.starts_with("t,x,y,z,fx,fy,fz,tx,ty,tz,depth,contact\n"));
}

TEST_CASE("Each stop signal ends a run with its report and exit code 0") {
  const int number = GENERATE(SIGINT, SIGTERM, SIGHUP);
  const Workshop shop;
  const Program run(shop.folder, {"run", "--asset", shop.full, "--json"});
  spm::servo::sleep_until(spm::servo::now_ns() + 600'000'000);
  run.signal(number);
  const Outcome outcome = run.wait();
  REQUIRE(outcome.code == 0);
  REQUIRE(json::parse(outcome.out)["force_off"].back()["cause"] == "stopping");
}

TEST_CASE("A file that is cut short under a run is named as asset_lost, and the run ends well") {
  const Workshop shop;
  const Program run(shop.folder, {"run", "--asset", shop.full, "--duration", "1.5", "--json"});
  spm::servo::sleep_until(spm::servo::now_ns() + 700'000'000);
  std::filesystem::resize_file(shop.full, 1000);
  const Outcome outcome = run.wait();
  REQUIRE(outcome.code == 0);
  const json report = json::parse(outcome.out);
  bool found = false;
  for (const json& entry : report["force_off"]) found = found || entry["cause"] == "asset_lost";
  REQUIRE(found);
  REQUIRE(outcome.err.find("asset_lost") != std::string::npos);
}

TEST_CASE("A replay reports everything that the contract names and writes its table") {
  const Workshop shop;
  const Outcome replay = servo(shop.folder, {"replay", shop.slide, "--asset", shop.full, "--out",
                                             shop.out, "--method", "paper", "--json"});
  REQUIRE(replay.code == 0);
  const json report = json::parse(replay.out);
  REQUIRE(report["ticks"] == 500);
  REQUIRE(report["contact_ticks"] == 500);
  for (const char* key : {"mean", "sd", "p50", "p99", "p999", "max"}) {
    REQUIRE(report["us_per_tick"][key].is_number());
  }
  for (const char* key : {"p50", "p99", "p999", "max"}) {
    REQUIRE(report["force_step_n"][key].is_number());
  }
  REQUIRE(report["method"] == "paper");
  REQUIRE(report["paper_rule"] == "closest-plane");
  REQUIRE(report["asset"]["form"] == "full");
  const std::string table = content(shop.out);
  REQUIRE(std::count(table.begin(), table.end(), '\n') == 501);
}

TEST_CASE("Quiet commands say nothing, others a summary") {
  const Workshop shop;
  const std::vector<std::string> command{"replay",  shop.slide, "--asset",
                                         shop.full, "--out",    shop.out};
  REQUIRE(servo(shop.folder, command).out.find("500 ticks") != std::string::npos);
  std::vector<std::string> quiet = command;
  quiet.emplace_back("--quiet");
  const Outcome outcome = servo(shop.folder, quiet);
  REQUIRE(outcome.code == 0);
  REQUIRE(outcome.out.empty());
  REQUIRE(outcome.err.empty());
}

TEST_CASE("A wrong command ends with the contract's exit code and one sentence") {
  const Workshop shop;
  std::ofstream(shop.folder.file("bad.txt")) << "0 0 0\n0 0 zero\n";
  std::ofstream(shop.folder.file("text.spm.exr")) << "no asset at all";
  const std::string run = "run --duration 0.1 --asset ";
  const std::string replay = "replay " + shop.slide + " --out " + shop.out + " --asset ";
  const std::string on = "replay " + shop.slide + " --out " + shop.out + " --scene ";
  const std::string object = "[[object]]\nasset = \"sparse.spm.exr\"\n";
  const std::vector<std::pair<std::string, int>> cases{
      {"", 1},
      {"sing", 1},
      {"run", 1},
      {run + shop.full + " --rate 100", 1},
      {run + shop.full + " --rate 5000", 1},
      {run + shop.full + " --rate nan", 1},
      {run + shop.full + " --rate 10kHz", 1},
      {run + shop.full + " --duration nan", 1},
      {run + shop.full + " --duration inf", 1},
      {run + shop.full + " --duration 0", 1},
      {run + shop.full + " --duration long", 1},
      {run + shop.full + " --realtime maybe", 1},
      {run + shop.full + " --map ram", 1},
      {run + shop.full + " --device falcon", 2},
      {run + shop.full + " --device falcon:colour=red", 1},
      {run + shop.full + " --device omega", 1},
      {run + shop.full + " --device sim:colour=red", 1},
      {run + shop.full + " --device sim:depth=1", 1},
      {run + shop.full + " --stiffness 1000", 1},
      {run + shop.full + " --stiffness -1N/mm", 1},
      {run + shop.full + " --stabilization dampng", 1},
      {run + shop.full + " --stabilization damping+", 1},
      {run + shop.full + " --method voxels", 1},
      {run + shop.full + " --method paper --probe sphere:1mm", 3},
      {run + shop.full + " --record", 1},
      {run + shop.full + " --record /nonexistent/a", 2},
      {run + shop.full + " --scene a", 1},
      {"run --duration 0.1 --scene " + shop.folder.file("none.toml"), 2},
      {"run --duration 0.1 --scene " + shop.scene("[[object]]\nasset = \"none.spm.exr\"\n"), 2},
      {"run --duration 0.1 --scene " + shop.scene("[[object]]\nmesh = \"a.obj\"\n"), 3},
      {"run --duration 0.1 --scene " + shop.scene("[device]\ndriver = \"falcon\"\n" + object), 2},
      {"run --duration 0.1 --scene " + shop.scene(object + "scale = 0\n"), 3},
      {run + shop.full + " --device sim:path=" + shop.folder.file("none.txt"), 2},
      {run + shop.full + " --device sim:path=" + shop.folder.file("bad.txt"), 3},
      {run + shop.full + " --trace " + shop.folder.file("none/a.csv"), 2},
      {run + shop.folder.file("none.spm.exr"), 2},
      {run + shop.folder.path(), 2},
      {run + shop.folder.file("text.spm.exr"), 3},
      {run + shop.sparse + " --method paper", 3},
      {run + shop.sparse + " --probe sphere:2mm", 3},
      {replay + shop.full + " --method voxels", 1},
      {"replay " + shop.slide + " --out " + shop.out, 1},
      {replay + shop.full + " --scene " + shop.scene(object), 1},
      {on + shop.scene(object) + " --stiffness 1000", 1},
      {on + shop.scene(""), 3},
      {on + shop.scene(object + "scale = -1\n"), 3},
      {on + shop.scene(object + "pose = [0, 0, 0, 1, 1, 0, 0]\n"), 3},
      {on + shop.scene(object + "friction = { slide = \"0.4\" }\n"), 3},
      {on + shop.scene(object + "damping = \"2\"\n"), 3},
      {on + shop.scene(object + "method = \"paper\"\n"), 3},
      {on + shop.scene("[tool]\nprobe = \"sphere:2mm\"\n" + object), 3},
      {on + shop.scene(object) + " --method paper", 3},
      {on + shop.scene("[[object]]\nasset = \"text.spm.exr\"\n"), 3},
      {on + shop.folder.file("none.toml"), 2},
      {replay + shop.full + " --method paper --probe sphere:1mm", 3},
      {replay + shop.full + " --paper-rule best", 1},
      {replay + shop.full + " --pace slow", 1},
      {replay + shop.full + " --probe ball", 1},
      {replay + shop.sparse + " --method paper", 3},
      {replay + shop.sparse + " --probe sphere:2mm", 3},
      {replay + shop.folder.file("none.spm.exr"), 2},
      {replay + shop.folder.file("text.spm.exr"), 3},
      {"replay " + shop.folder.file("none.txt") + " --out a.csv --asset " + shop.full, 2},
      {"replay " + shop.folder.file("bad.txt") + " --out " + shop.out + " --asset " + shop.full, 3},
      {"replay " + shop.slide + " --asset " + shop.full, 1},
      {"replay " + shop.slide + " --out " + shop.folder.file("none/a.csv") + " --asset " +
           shop.full,
       2},
      {"replay " + shop.slide + " --out " + shop.folder.path() + " --asset " + shop.full, 2},
  };
  for (const auto& [line, code] : cases) {
    CAPTURE(line);
    const Outcome outcome = servo(shop.folder, words(line));
    CAPTURE(outcome.err);
    REQUIRE(outcome.code == code);
    REQUIRE(outcome.out.empty());
    require_one_sentence(outcome.err);
    REQUIRE_FALSE(std::filesystem::exists(shop.out));
  }
}

TEST_CASE("Several devices run in one loop") {
  const Workshop shop;
  const Outcome run =
      servo(shop.folder, {"run", "--asset", shop.full, "--duration", "0.3", "--device",
                          "sim:profile=low", "--device", "sim:profile=falcon,seed=2", "--json"});
  REQUIRE(run.code == 0);
  const json report = json::parse(run.out);
  REQUIRE(report["devices"].size() == 2);
  REQUIRE(report["devices"][1]["profile"] == "falcon");
}

TEST_CASE("Help and version go to stdout with exit code 0") {
  const Workshop shop;
  for (const char* line : {"--help", "--version", "run --help", "replay --help", "run --version"}) {
    CAPTURE(line);
    const Outcome outcome = servo(shop.folder, words(line));
    REQUIRE(outcome.code == 0);
    REQUIRE_FALSE(outcome.out.empty());
    REQUIRE(outcome.err.empty());
  }
}

}  // namespace command_test
