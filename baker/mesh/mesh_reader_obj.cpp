// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "baker/mesh/mesh_reader.hpp"
#include "baker/mesh/mesh_text.hpp"

namespace spm::baker {
namespace {

/// Faces as the file has them, resolved to indices from 0 but not yet checked against the number of
/// vertices: a face may stand before its vertices.
struct Faces {
  std::vector<std::int64_t> corners;
  std::vector<std::size_t> ends;   ///< of each face in `corners`
  std::vector<std::size_t> lines;  ///< of each face
  std::size_t single = 0;          ///< faces of one vertex, which are left out
};

void read_face(MeshText& text, std::size_t vertices, Faces& faces) {
  const std::size_t begin = faces.corners.size();
  for (std::string_view word = text.next_word(); !word.empty(); word = text.next_word()) {
    const std::int64_t index = text.integer(word.substr(0, word.find('/')), "vertex index");
    if (index == 0) {
      text.fail("vertex index 0, but OBJ counts from 1", "export the mesh again");
    }
    const std::int64_t resolved =
        index > 0 ? index - 1 : static_cast<std::int64_t>(vertices) + index;
    if (resolved < 0) {
      text.fail("vertex index " + std::to_string(index) + " reaches back before the first of " +
                    std::to_string(vertices) + " vertices",
                "export the mesh again");
    }
    faces.corners.push_back(resolved);
  }
  if (faces.corners.size() - begin == 1) {
    faces.corners.pop_back();
    ++faces.single;
    return;
  }
  if (faces.corners.size() - begin < 3) {
    text.fail("face with " + std::to_string(faces.corners.size() - begin) + " vertices",
              "a face needs 3 or more, export the mesh again");
  }
  faces.ends.push_back(faces.corners.size());
  faces.lines.push_back(text.line());
}

/// A line that ends in a backslash continues in the next one.
[[nodiscard]] std::string joined_lines(std::string_view bytes) {
  std::string joined(bytes);
  for (std::size_t at = joined.find('\\'); at != std::string::npos;
       at = joined.find('\\', at + 1)) {
    std::size_t end = at + 1;
    if (end < joined.size() && joined[end] == '\r') ++end;
    if (end >= joined.size() || joined[end] != '\n') continue;
    for (std::size_t i = at; i <= end; ++i) joined[i] = ' ';
  }
  return joined;
}

}  // namespace

PolygonSoup read_obj(const std::string& path, std::string_view bytes) {
  std::string joined;
  if (bytes.find('\\') != std::string_view::npos) bytes = joined = joined_lines(bytes);
  MeshText text(path, bytes);
  PolygonSoup soup;
  Faces faces;
  while (text.next_line()) {
    const std::string_view keyword = text.next_word();
    if (keyword == "v") {
      soup.points.push_back(text.point("the file may be cut short, export the mesh again"));
    } else if (keyword == "f") {
      read_face(text, soup.points.size(), faces);
    }
  }
  std::size_t begin = 0;
  std::vector<std::uint32_t> polygon;
  for (std::size_t face = 0; face < faces.ends.size(); ++face) {
    polygon.clear();
    for (std::size_t i = begin; i < faces.ends[face]; ++i) {
      if (faces.corners[i] >= static_cast<std::int64_t>(soup.points.size())) {
        text.fail_at(faces.lines[face],
                     "vertex index " + std::to_string(faces.corners[i] + 1) + " is out of range (" +
                         std::to_string(soup.points.size()) + " vertices)",
                     "the file may be cut short, export the mesh again");
      }
      polygon.push_back(static_cast<std::uint32_t>(faces.corners[i]));
    }
    begin = faces.ends[face];
    add_polygon(polygon, soup);
  }
  if (faces.single > 0) {
    soup.notes.push_back(std::to_string(faces.single) + (faces.single == 1 ? " face" : " faces") +
                         " of a single vertex left out.");
  }
  return soup;
}

}  // namespace spm::baker
