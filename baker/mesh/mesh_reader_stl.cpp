// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "baker/mesh/mesh_reader.hpp"
#include "baker/mesh/mesh_text.hpp"

namespace spm::baker {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;
constexpr std::size_t kNormalBytes = 12;

/// Binary STL is little-endian, on any machine.
[[nodiscard]] std::uint32_t word_at(const char* bytes) {
  std::uint32_t word = 0;
  for (unsigned k = 0; k < 4; ++k) {
    word |= std::uint32_t{static_cast<unsigned char>(bytes[k])} << (8 * k);
  }
  return word;
}

[[nodiscard]] std::uint32_t triangle_count(std::string_view bytes) {
  return word_at(bytes.data() + kHeaderBytes - 4);
}

void add_triangle(PolygonSoup& soup) {
  const auto last = static_cast<std::uint32_t>(soup.points.size());
  soup.triangles.push_back({last - 3, last - 2, last - 1});
}

[[nodiscard]] PolygonSoup read_binary(const std::string& path, std::string_view bytes) {
  if (bytes.size() < kHeaderBytes) {
    refuse_file(
        path,
        "the file ends within the STL header after " + std::to_string(bytes.size()) + " bytes",
        "it was cut short, copy or export the mesh again");
  }
  const std::uint32_t count = triangle_count(bytes);
  const std::uint64_t expected = kHeaderBytes + std::uint64_t{count} * kTriangleBytes;
  // As many bytes as a triangle takes may be one that the count has missed.
  if (bytes.size() < expected || bytes.size() - expected >= kTriangleBytes) {
    refuse_file(path,
                "the STL header announces " + std::to_string(count) + " triangles in " +
                    std::to_string(expected) + " bytes, but the file has " +
                    std::to_string(bytes.size()),
                "it was cut short or is damaged, copy or export the mesh again");
  }
  PolygonSoup soup;
  soup.points.reserve(std::size_t{count} * 3);
  soup.triangles.reserve(count);
  for (std::uint32_t triangle = 0; triangle < count; ++triangle) {
    const char* at = bytes.data() + kHeaderBytes + std::size_t{triangle} * kTriangleBytes;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Vector3 point;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        point[axis] = std::bit_cast<float>(word_at(at + kNormalBytes + 4 * (3 * corner + axis)));
      }
      if (!point.allFinite()) {
        refuse_file(path + ": triangle " + std::to_string(triangle) + " (counted from 0)",
                    "a coordinate is not finite", "remove or mend it and export the mesh again");
      }
      soup.points.push_back(point);
    }
    add_triangle(soup);
  }
  if (bytes.size() > expected) {
    soup.notes.push_back("Bytes behind the triangles of the STL, which are not read: " +
                         std::to_string(bytes.size() - expected) + ".");
  }
  return soup;
}

/// The next keyword of a line, in lower case; the ends may be in two words ("end loop").
[[nodiscard]] std::string keyword_of(std::string_view word, MeshText& text) {
  std::string keyword = lower_case(word);
  return keyword == "end" ? keyword + lower_case(text.next_word()) : keyword;
}

/// One facet, after its word "facet" was read. The normal is skipped: the order of the vertices
/// says more.
void read_facet(MeshText& text, PolygonSoup& soup) {
  std::size_t corners = 0;
  while (true) {
    const std::string word = keyword_of(text.next_word_anywhere("endfacet"), text);
    if (word == "endfacet") break;
    if (word != "vertex") continue;
    Vector3 point;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = text.number(text.next_word_anywhere("a vertex's coordinates"), "coordinate");
    }
    soup.points.push_back(point);
    ++corners;
  }
  if (corners != 3) {
    text.fail("facet with " + std::to_string(corners) + " vertices",
              "STL holds triangles only, export the mesh again");
  }
  add_triangle(soup);
}

[[nodiscard]] PolygonSoup read_text(const std::string& path, std::string_view bytes) {
  MeshText text(path, bytes);
  PolygonSoup soup;
  bool open = false;
  while (text.next_line()) {
    const std::string keyword = keyword_of(text.next_word(), text);
    if (keyword == "solid") {
      open = true;
    } else if (keyword == "facet") {
      read_facet(text, soup);
    } else if (keyword == "endsolid") {
      open = false;
    } else {
      text.fail("neither solid, facet nor endsolid", "the file is damaged, export the mesh again");
    }
  }
  if (open) text.fail_cut_short("endsolid");
  return soup;
}

}  // namespace

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= kHeaderBytes &&
         bytes.size() == kHeaderBytes + std::uint64_t{triangle_count(bytes)} * kTriangleBytes;
}

PolygonSoup read_stl(const std::string& path, std::string_view bytes) {
  // A binary file may begin with "solid" too; text never has a zero byte.
  const std::size_t start = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  const bool text = !is_binary_stl(bytes) && lower_case(bytes.substr(start, 5)) == "solid" &&
                    bytes.find('\0') == std::string_view::npos;
  return text ? read_text(path, bytes) : read_binary(path, bytes);
}

}  // namespace spm::baker
