// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "baker/mesh/mesh_reader.hpp"
#include "baker/mesh/mesh_text.hpp"

namespace spm::baker {
namespace {

[[nodiscard]] std::size_t read_count(MeshText& text, std::size_t most, const char* what) {
  const std::int64_t count = text.integer(text.next_word_anywhere("its counts"), what);
  if (count < 0) text.fail(std::string(what) + " is negative", "export the mesh again");
  // Each vertex and face takes at least two bytes: a larger count is damage, not a reason to
  // allocate.
  if (static_cast<std::uint64_t>(count) > most) {
    text.fail(std::string(what) + " " + std::to_string(count) + " is more than the file can hold",
              "it is damaged or was cut short, export the mesh again");
  }
  return static_cast<std::size_t>(count);
}

void read_face(MeshText& text, std::vector<std::uint32_t>& polygon, PolygonSoup& soup) {
  const std::int64_t corners = text.integer(text.next_word(), "number of corners");
  if (corners < 3) {
    text.fail("face with " + std::to_string(corners) + " vertices",
              "a face needs 3 or more, export the mesh again");
  }
  polygon.clear();
  for (std::int64_t i = 0; i < corners; ++i) {
    const std::string_view word = text.next_word();
    if (word.empty()) {
      text.fail("face of " + std::to_string(corners) + " vertices lists only " + std::to_string(i),
                "export the mesh again");
    }
    const std::int64_t index = text.integer(word, "vertex index");
    if (index < 0 || index >= static_cast<std::int64_t>(soup.points.size())) {
      text.fail("vertex index " + std::to_string(index) + " is out of range (" +
                    std::to_string(soup.points.size()) + " vertices)",
                "export the mesh again");
    }
    polygon.push_back(static_cast<std::uint32_t>(index));
  }
  add_polygon(polygon, soup);
}

}  // namespace

PolygonSoup read_off(const std::string& path, std::string_view bytes) {
  MeshText text(path, bytes);
  if (!text.next_line()) text.fail_cut_short("its header");
  std::string_view word = text.next_word();
  // The first count may be joined to the first word: "OFF8 6 12".
  const std::size_t end = std::min(word.find("OFF"), word.size()) + 3;
  const bool counts = end < word.size();
  if (end > word.size() || (counts && (word[end] < '0' || word[end] > '9'))) {
    text.fail("the first word is not OFF", "the file is of another format, or damaged");
  }
  const std::string_view magic = word.substr(0, end);
  // Normals, colours and texture coordinates after a vertex's position are skipped. A fourth or
  // n-th dimension would change the position itself.
  if (magic.find('4') != std::string_view::npos || magic.find('n') != std::string_view::npos) {
    text.fail("OFF of more than 3 dimensions", "export the mesh as plain OFF");
  }
  word = counts ? word.substr(end) : text.next_word();
  if (word == "BINARY") text.fail("binary OFF is not read", "export the mesh as text OFF or PLY");
  PolygonSoup soup;
  if (!word.empty()) {
    text = MeshText(path, bytes, static_cast<std::size_t>(word.data() - bytes.data()),
                    text.line() - 1);
  }
  const std::size_t vertices = read_count(text, bytes.size() / 2, "number of vertices");
  const std::size_t faces = read_count(text, bytes.size() / 2, "number of faces");
  for (std::size_t i = 0; i < vertices; ++i) {
    if (!text.next_line()) text.fail_cut_short("vertex " + std::to_string(i));
    soup.points.push_back(text.point("export the mesh again"));
  }
  std::vector<std::uint32_t> polygon;
  for (std::size_t i = 0; i < faces; ++i) {
    if (!text.next_line()) text.fail_cut_short("face " + std::to_string(i));
    read_face(text, polygon, soup);
  }
  return soup;
}

}  // namespace spm::baker
