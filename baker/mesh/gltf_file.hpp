// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace spm::baker {

/// A glTF 2.0 file, opened: what it describes, and the bytes of its buffers.
// NOLINTNEXTLINE(bugprone-exception-escape): a JSON value allocates while it is destroyed.
struct GltfFile {
  nlohmann::json json;
  std::vector<std::string> buffers;
  std::vector<std::string> companion_digests;  ///< SHA-256 of each buffer that is another file
};

/// Opens the bytes of a `.gltf` or a `.glb`. Buffers may be in the file, in its text, or in regular
/// files in its folder or below; `outside_buffers`: elsewhere too. Throws BakeError: file_or_device
/// for a buffer that cannot be read; invalid_input, also for more than 4 GiB of buffers.
[[nodiscard]] GltfFile open_gltf(const std::string& path, std::string_view bytes,
                                 bool outside_buffers);

/// The files with buffers that a glTF names. Throws BakeError invalid_input.
[[nodiscard]] std::vector<std::string> gltf_companions(const std::string& path,
                                                       std::string_view bytes,
                                                       bool outside_buffers);

/// Whether bytes are those of a `.glb`, and whether they look like a `.gltf`.
[[nodiscard]] bool is_glb(std::string_view bytes);
[[nodiscard]] bool resembles_gltf(std::string_view bytes);

}  // namespace spm::baker
