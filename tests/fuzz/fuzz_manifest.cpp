// SPDX-License-Identifier: GPL-3.0-or-later
// Manifests of any text.
#include "baker/batch/manifest.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace spm::fuzz {

std::vector<std::string> seeds() {
  return {R"([defaults]
unit = "mm"
tolerance = "50um"
open = "auto"
fail-on = "open,sheets"
[[asset]]
mesh = "meshes/a.obj"
output = "baked/a.spm.exr"
name = "a"
max-bytes = 100000
[[asset]]
mesh = "b.stl"
output = "baked/{stem}.spm.exr"
form = "full"
planes = 42
allow-inexact = true
)",
          R"([[asset]]
mesh = "a.obj"
output = "{folder}-{stem}.exr"
probe = "sphere:1mm"
smooth = "crease:30deg"
layers = 3
seed = 18446744073709551615
[[scene]]
scene = "a.toml"
output = "b.toml"
)"};
}

std::vector<std::string> endings() { return {".toml"}; }

}  // namespace spm::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static spm::fuzz::ScratchFile file;
  const std::string text(reinterpret_cast<const char*>(data), size);
  // A pattern would search the disk.
  if (text.find('*') != std::string::npos) return 0;
  file.write(text);
  const auto manifest = spm::baker::read_manifest(file.path());
  if (!manifest) {
    spm::fuzz::require(!manifest.error().message.empty(), "a refusal says why");
    return 0;
  }
  for (const spm::baker::ManifestEntry& entry : manifest->entries) {
    spm::fuzz::require(!entry.request.output.empty() && !entry.request.mesh.empty(),
                       "an entry has a mesh and an output");
  }
  return 0;
}
