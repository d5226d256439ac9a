// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/build/build_request.hpp"
#include "common/base/error.hpp"

namespace spm::baker {

/// One asset of a manifest. A table whose mesh is a pattern gives one for each mesh that it finds.
struct ManifestEntry {
  std::string name;
  BuildRequest request;           ///< paths made relative to the manifest's folder
  std::string output;             ///< as the manifest means it: the same wherever it lies
  std::uint32_t mesh_line = 0;    ///< where `mesh` stands
  std::uint32_t output_line = 0;  ///< where `output` stands
};

/// The baked file of an object or a tool of a scene.
struct ScenePart {
  std::string asset;                 ///< its path
  std::optional<std::size_t> entry;  ///< whose output it is; empty: a file that was there before
};

/// A scene of a manifest, which its assets are baked for.
struct ManifestScene {
  std::string name;
  std::string scene;  ///< file, made relative to the manifest's folder
  std::string text;   ///< what was in it when the manifest was read; what is written is of this
  std::vector<ScenePart> parts;  ///< its objects, then its tools
  std::string output;            ///< file to write, likewise; empty where it is only checked
  std::uint32_t line = 0;        ///< where `scene` stands
  std::uint32_t output_line = 0;
};

struct Manifest {
  std::string path;
  std::string sha256;  ///< of the file's bytes
  std::vector<ManifestEntry> entries;
  std::vector<ManifestScene> scenes;
  std::vector<std::string> searched_folders;  ///< where patterns looked
};

/// Reads a manifest (TOML): `[[asset]]` tables with `mesh`, `output` and optionally `name`
/// (default: the output's file name up to its first dot), and a table `[defaults]` with what they
/// do not say themselves. Any option of `build` may stand there by its long name, with its unit in
/// a string. `mesh` may be a pattern; `{stem}` and `{folder}` in `output` and `name` stand for the
/// mesh's file name without its extension and for its folder's name. `[[scene]]` tables have
/// `scene`, also a pattern, and optionally `output` and `name`. Errors: file_or_device; those of
/// find_parts; invalid_input, which names the line and, for a misspelt key, the key that was
/// probably meant.
[[nodiscard]] Result<Manifest> read_manifest(const std::string& path);

}  // namespace spm::baker
