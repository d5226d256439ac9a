// SPDX-License-Identifier: Apache-2.0
// Scenes of any text.
#include <cmath>

#include "formats/scene/scene.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace spm::fuzz {

std::vector<std::string> seeds() {
  return {R"([device]
driver = "falcon"
profile = "falcon"
force_cap = "6N"
[tool]
probe = "sphere:0.5mm"
[workspace]
pose = [0, 0.1, 0]
scale = 2
[[object]]
mesh = "teeth.obj"
asset = "teeth.spm.exr"
pose = [0.1, 0, -2e-2, 0.70711, 0, 0.70711, 0]
scale = 1.5
stiffness = "0.8N/mm"
friction = { stick = 0.5, slide = 0.4, stiffness = "2N/mm" }
texture = { amplitude = "50um", wavelength = "1mm" }
movable = true
)",
          R"([[tool]]
asset = "drill.spm.exr"
pose = [0, 0, 0]
scale = 0.5
coupling = "1N/mm"
turning = "1Nm/rad"
torque_cap = "0.1Nm"
budget = "0.3ms"
[stabilization]
passivity = true
[[object]]
asset = "a"
method = "paper"
)"};
}

std::vector<std::string> endings() { return {".toml"}; }

}  // namespace spm::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static spm::fuzz::ScratchFile file;
  file.write({reinterpret_cast<const char*>(data), size});
  const auto scene = spm::read_scene(file.path());
  if (!scene) {
    spm::fuzz::require(!scene.error().message.empty(), "a refusal says why");
    return 0;
  }
  for (const spm::SceneObject& object : scene->objects) {
    spm::fuzz::require(object.placement.position.allFinite() && object.placement.scale > 0 &&
                           std::abs(object.placement.rotation.norm() - 1) < 1e-9,
                       "an object lies somewhere");
  }
  return 0;
}
