// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/vector.hpp"
#include "formats/files/open_as.hpp"

namespace spm::baker {

using Triangle = std::array<std::uint32_t, 3>;

/// A hole of a solid's surface, which a lid closes.
struct Hole {
  Vector3 middle = Vector3::Zero();  ///< of its border, m
  double area = 0;                   ///< of its lid, m2
  std::size_t edges = 0;             ///< of its border
};

/// How often something was met, and a vertex at which it was, the first time.
struct Counted {
  std::uint64_t count = 0;
  std::uint32_t vertex = 0;

  void add(std::uint64_t more, std::uint32_t at) noexcept {
    if (count == 0) vertex = at;
    count += more;
  }
};

/// What a mesh may have that somebody may not want.
enum class FindingKind : std::uint8_t {
  open,
  nonmanifold,
  selfintersecting,
  sheets,
  lids,
  repaired
};
/// The words of `--fail-on`, in that order.
inline constexpr std::array<const char*, 6> finding_words{
    "open", "nonmanifold", "selfintersecting", "sheets", "lids", "repaired"};

/// By FindingKind: whether a mesh that has it is refused.
using FailOn = std::array<bool, finding_words.size()>;

/// Something that was found in a mesh, or mended.
struct MeshFinding {
  FindingKind kind = FindingKind::repaired;
  std::uint64_t count = 0;
  std::string what;                 ///< a sentence for the user, the count its first word
  Vector3 place = Vector3::Zero();  ///< of one of them, m
};

/// A mesh after loading, repair, unit and scale: in metres, in the asset's frame, by the rules of
/// SOLID.md. Triangles of solids are closed, and their normals point out; then come those of
/// sheets, which are felt from both sides.
struct Mesh {
  std::vector<Vector3> vertices;    ///< all are referenced
  std::vector<Triangle> triangles;  ///< no index out of range, no zero area
  std::size_t sheet_triangles = 0;  ///< so many of them, the last, are of sheets
  std::size_t lid_triangles = 0;    ///< so many before these are of lids
  std::string path;
  std::string sha256;       ///< of the file's bytes; see mesh_sha256
  double unit = 1;          ///< metres per unit of the file
  bool unit_named = false;  ///< by the file or by whoever loads it; else it is taken for 1
  double scale = 1;         ///< of --fit-diagonal
  OpenAs open_as = OpenAs::automatic;
  Vector3 box_min = Vector3::Zero();
  Vector3 box_max = Vector3::Zero();
  double diagonal = 0;
  std::uint64_t file_triangles = 0;  ///< after fanning polygons, before repair
  std::uint64_t file_vertices = 0;
  std::uint32_t components = 0;
  std::uint64_t border_edges = 0;         ///< of the file's surface
  std::vector<Hole> lids;                 ///< holes that triangles of the mesh close, largest first
  std::uint32_t sheets = 0;               ///< parts that are sheets
  std::uint32_t inverted_components = 0;  ///< components that were inside out
  std::uint64_t dropped_triangles = 0;    ///< zero area or duplicated
  std::uint64_t copies = 0;               ///< of these, that lay on another with the same corners
  std::uint64_t welded = 0;               ///< vertices of borders that became one with another
  std::vector<MeshFinding> findings;      ///< of the rules of SOLID.md, in their order
  std::vector<std::string> notes;  ///< these and other assumptions, a sentence each, for the user
  [[nodiscard]] bool closed() const noexcept { return sheet_triangles == 0; }
  [[nodiscard]] std::size_t solid_triangles() const noexcept {
    return triangles.size() - sheet_triangles;
  }
};

}  // namespace spm::baker
