// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/build/scene_limits.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "baker/base/bake_error.hpp"
#include "tests/baker/pipeline/bake_support.hpp"

namespace spm::baker::scene_limits_test {
namespace {

/// A folder with two meshes and a scene, gone at the end.
class SceneFolder {
 public:
  explicit SceneFolder(const std::string& scene) {
    const auto name = "spm-scene-" + std::to_string(::getpid());
    folder_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::create_directories(folder_);
    for (const char* mesh : {"a.obj", "b.obj"}) std::ofstream(folder_ / mesh) << "v 0 0 0\n";
    std::ofstream(folder_ / "scene.toml") << scene;
  }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;
  ~SceneFolder() { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] LimitSources sources() const {
    LimitSources sources;
    sources.scene = path("scene.toml");
    return sources;
  }

 private:
  std::filesystem::path folder_;
};

bool tells(const std::vector<std::string>& sentences, const std::string& what) {
  return std::any_of(sentences.begin(), sentences.end(), [&](const std::string& sentence) {
    return sentence.find(what) != std::string::npos;
  });
}

/// The code and message of what a call throws; `done` where it throws nothing.
template <class Call>
Error thrown_by(const Call& call) {
  try {
    call();
  } catch (const BakeError& error) {
    return {error.code(), error.what()};
  }
  return {ExitCode::done, ""};
}

constexpr const char* falcon_scene = R"(
[device]
profile = "falcon"
[tool]
probe = "sphere:1mm"
[[object]]
mesh = "a.obj"
stiffness = "4N/mm"
)";

TEST_CASE("A device alone gives the tolerance and leaves the band") {
  LimitSources sources;
  sources.device = "omega3";
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  const auto derived = derive_limits(sources, "a.obj", options, open);
  CHECK(*options.tolerance == Approx(4.5e-6));
  CHECK(options.max_depth == 0.002);
  CHECK_FALSE(options.workspace);
  CHECK(tells(derived, "tolerance 4.5 um: half of omega3's encoder step of 9 um"));
}

TEST_CASE("A scene gives tolerance, band, probe and workspace, and tells from what") {
  const SceneFolder folder(falcon_scene);
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  const auto derived = derive_limits(folder.sources(), folder.path("a.obj"), options, open);
  CHECK(*options.tolerance == Approx(32e-6));
  CHECK(options.max_depth == Approx(0.002));
  CHECK(options.probe_radius == Approx(0.001));
  CHECK_FALSE(options.margin);
  REQUIRE(options.workspace);
  CHECK(options.workspace->half.x() == Approx(0.051));
  CHECK(options.workspace->middle == Vector3::Zero());
  CHECK(tells(derived, "max-depth 2 mm: 8 N over 4 N/mm"));
  CHECK(tells(derived, "probe sphere of radius 1 mm"));
  CHECK(tells(derived, "falcon's, as "));
  CHECK(tells(derived, "stiffness 4 N/mm: more than falcon renders stably, 3 N/mm"));
}

TEST_CASE("What the command line gives wins over the scene") {
  const SceneFolder folder(falcon_scene);
  LimitSources sources = folder.sources();
  sources.tolerance_given = sources.max_depth_given = sources.probe_given = true;
  sources.device = "omega3";
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  options.tolerance = 50e-6;
  options.max_depth = 0.001;
  options.probe_radius = 0.003;
  const auto derived = derive_limits(sources, folder.path("a.obj"), options, open);
  CHECK(*options.tolerance == 50e-6);
  CHECK(options.max_depth == 0.001);
  CHECK(options.probe_radius == 0.003);
  CHECK(options.workspace->half.z() == Approx(0.055));
  CHECK(derived.size() == 1);  // the workspace
}

TEST_CASE("A placed object turns lengths of the world and the workspace into its own frame") {
  const SceneFolder folder(R"(
[device]
profile = "omega3"
force_cap = "10N"
[tool]
probe = "sphere:1mm"
[workspace]
pose = [0.1, 0, 0]
scale = 4
[[object]]
mesh = "a.obj"
pose = [0, 0.2, 0, 0.7071067811865476, 0, 0, 0.7071067811865476]
scale = 2
stiffness = "1N/mm"
)");
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  const auto derived = derive_limits(folder.sources(), folder.path("a.obj"), options, open);
  CHECK(*options.tolerance == Approx(4.5e-6 * 4 / 2));
  CHECK(options.max_depth == Approx(0.01 / 2));
  CHECK(options.probe_radius == Approx(0.0005));
  // The object is turned by 90 degrees about z: its x axis is the world's y axis.
  CHECK((options.workspace->middle - Vector3(-0.1, -0.05, 0)).norm() < 1e-12);
  CHECK((options.workspace->axes.col(0) - Vector3(0, -1, 0)).norm() < 1e-12);
  CHECK((options.workspace->half - Vector3(0.08, 0.08, 0.055) * 2).norm() < 1e-12);
  CHECK(tells(derived, "at a scale of 1 to 0.5"));
}

TEST_CASE("A scene without a device gives what it can") {
  const SceneFolder folder("tool.probe = \"sphere:1mm\"\n[[object]]\nmesh = \"a.obj\"\n");
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  const auto derived = derive_limits(folder.sources(), folder.path("a.obj"), options, open);
  CHECK_FALSE(options.tolerance);
  CHECK_FALSE(options.workspace);
  CHECK(options.max_depth == 0.002);
  CHECK(options.probe_radius == Approx(0.001));
  CHECK(derived.size() == 1);
}

TEST_CASE("An object of a scene says what its open parts are taken for") {
  const SceneFolder folder("[[object]]\nmesh = \"a.obj\"\nopen = \"sheet\"\n");
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  const auto derived = derive_limits(folder.sources(), folder.path("a.obj"), options, open);
  CHECK(open == OpenAs::sheet);
  CHECK(tells(derived, "open sheet: the object's in "));
  LimitSources sources = folder.sources();
  sources.open_given = true;
  open = OpenAs::solid;
  (void)derive_limits(sources, folder.path("a.obj"), options, open);
  CHECK(open == OpenAs::solid);
}

TEST_CASE("A full asset takes no tolerance from a scene") {
  const SceneFolder folder(falcon_scene);
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  options.form = AssetForm::full;
  (void)derive_limits(folder.sources(), folder.path("a.obj"), options, open);
  CHECK_FALSE(options.tolerance);
  CHECK(options.workspace);
}

TEST_CASE("The object is the one with the mesh, or the only one") {
  const std::string two =
      "[[object]]\nmesh = \"b.obj\"\nstiffness = \"1N/mm\"\n"
      "[[object]]\nmesh = \"./a.obj\"\nstiffness = \"2N/mm\"\n";
  const std::string device = "device.profile = \"touch\"\n";
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  {
    const SceneFolder folder(device + two);
    (void)derive_limits(folder.sources(), folder.path("a.obj"), options, open);
    CHECK(options.max_depth == Approx(3.3 / 2000));
    const Error error = thrown_by(
        [&] { (void)derive_limits(folder.sources(), folder.path("scene.toml"), options, open); });
    CHECK(error.code == ExitCode::invalid_input);
    CHECK(error.message.find("none of its 2 objects") != std::string::npos);
  }
  {
    const SceneFolder folder("[[object]]\nmesh = \"a.obj\"\n[[object]]\nmesh = \"a.obj\"\n");
    const Error error = thrown_by(
        [&] { (void)derive_limits(folder.sources(), folder.path("a.obj"), options, open); });
    CHECK(error.code == ExitCode::invalid_input);
    CHECK(error.message.find("lines 1 and 3") != std::string::npos);
  }
  const SceneFolder folder(device + "[[object]]\nasset = \"c.spm.exr\"\n");
  (void)derive_limits(folder.sources(), folder.path("a.obj"), options, open);
  CHECK(options.max_depth == Approx(3.3 / 400));
}

TEST_CASE("A band wider than the object is refused, whoever asked for it") {
  const Mesh mesh = test::mesh_of(test::box({0.02, 0.02, 0.02}));
  LimitSources sources;
  BakeOptions options;
  check_limits(sources, options, mesh, false);
  options.max_depth = 0.05;
  check_limits(sources, options, mesh, false);  // a default may be deeper than a small object
  sources.max_depth_given = true;
  Error error = thrown_by([&] { check_limits(sources, options, mesh, false); });
  CHECK(error.code == ExitCode::usage);
  CHECK(error.message.find("--max-depth: 50 mm is more than the object's") == 0);
  sources.max_depth_given = false;
  sources.scene = "scene.toml";
  error = thrown_by([&] { check_limits(sources, options, mesh, false); });
  CHECK(error.code == ExitCode::invalid_input);
  CHECK(error.message.find("raise 'stiffness'") != std::string::npos);
  options.max_depth = 0.002;
  options.margin = 0.06;
  error = thrown_by([&] { check_limits(sources, options, mesh, false); });
  CHECK(error.code == ExitCode::usage);
  options.probe_radius = 0.05;  // a probe larger than the object is not an error
  CHECK(thrown_by([&] { check_limits(sources, options, mesh, false); }).code == ExitCode::done);
}

TEST_CASE("A tolerance that floats cannot hold is refused, unless inexactness is allowed") {
  const Mesh mesh = test::mesh_of(test::box({0.02, 0.02, 0.02}));
  LimitSources sources;
  sources.tolerance_given = true;
  BakeOptions options;
  options.tolerance = 1e-12;
  const Error error = thrown_by([&] { check_limits(sources, options, mesh, false); });
  CHECK(error.code == ExitCode::usage);
  CHECK(error.message.find("finer than the floats") != std::string::npos);
  check_limits(sources, options, mesh, true);
  options.tolerance = 1e-8;
  check_limits(sources, options, mesh, false);
  sources.tolerance_given = false;
  sources.device = "omega3";
  options.tolerance = 4.5e-6;
  const Mesh large = test::mesh_of(test::box({2000, 2000, 2000}));
  CHECK(thrown_by([&] { check_limits(sources, options, large, false); }).code ==
        ExitCode::invalid_input);
}

TEST_CASE("A workspace with nothing of the object in it is refused") {
  const Mesh mesh = test::mesh_of(test::box({0.02, 0.02, 0.02}));
  LimitSources sources;
  sources.scene = "scene.toml";
  BakeOptions options;
  options.workspace.emplace();
  options.workspace->half = Vector3::Constant(0.005);
  const auto code_at = [&](const Vector3& middle) {
    options.workspace->middle = middle;
    return thrown_by([&] { check_limits(sources, options, mesh, false); });
  };
  CHECK(code_at({0.015, 0, 0}).code == ExitCode::done);
  CHECK(code_at({0.016, 0, 0}).code == ExitCode::done);  // the band reaches in
  const Error outside = code_at({0.05, 0, 0});
  CHECK(outside.code == ExitCode::invalid_input);
  CHECK(outside.message.find("nothing of shape.obj is in the device's workspace, 10 mm") !=
        std::string::npos);
  CHECK(code_at(Vector3::Zero()).code == ExitCode::invalid_input);  // deep in the solid
  const double turn = std::numbers::pi / 4;
  options.workspace->axes.col(0) = Vector3(std::cos(turn), std::sin(turn), 0);
  options.workspace->axes.col(1) = Vector3(-std::sin(turn), std::cos(turn), 0);
  CHECK(code_at({0.018, 0, 0}).code == ExitCode::done);
  CHECK(code_at({0.021, 0, 0}).code == ExitCode::invalid_input);
}

TEST_CASE("The tool of a scene is baked whole, and its objects as without it") {
  const SceneFolder folder(R"(
[device]
profile = "falcon"
[tool]
mesh = "b.obj"
asset = "b.spm.exr"
scale = 2
[[object]]
mesh = "a.obj"
stiffness = "4N/mm"
)");
  BakeOptions options;
  OpenAs open = OpenAs::automatic;
  const auto derived = derive_limits(folder.sources(), folder.path("b.obj"), options, open);
  CHECK_FALSE(options.workspace);
  CHECK(options.probe_radius == 0);
  CHECK(options.max_depth == 0.002);
  CHECK(*options.tolerance == Approx(16e-6));
  CHECK(tells(derived, "the tool of "));
  BakeOptions of_object;
  static_cast<void>(derive_limits(folder.sources(), folder.path("a.obj"), of_object, open));
  CHECK(of_object.workspace);
  CHECK(of_object.probe_radius == 0);
  CHECK(*of_object.tolerance == Approx(32e-6));
}

}  // namespace
}  // namespace spm::baker::scene_limits_test
