// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/mesh_reader.hpp"
#include "baker/mesh/mesh_text.hpp"

namespace spm::baker {
namespace {

constexpr std::string_view strips_name = "tristrips";

enum class Encoding { text, little_endian, big_endian };

/// A number of some bytes, of this machine's order.
template <class T>
[[nodiscard]] double decode_as(const char* raw) {
  T value;
  std::memcpy(&value, raw, sizeof value);
  return static_cast<double>(value);
}

struct Type {
  std::size_t bytes = 0;
  double (*decode)(const char* raw) = nullptr;
  bool real = false;
};

struct Property {
  std::string name;
  Type type;                  ///< of the value, or of each item of a list
  std::optional<Type> count;  ///< of a list's length
};

struct Element {
  std::string name;
  std::size_t items = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
};

[[nodiscard]] Type parse_type(const MeshText& text, std::string_view word) {
  struct Named {
    std::string_view name, alias;
    Type type;
  };
  static constexpr std::array<Named, 8> kTypes{
      {{"char", "int8", {1, decode_as<std::int8_t>}},
       {"uchar", "uint8", {1, decode_as<std::uint8_t>}},
       {"short", "int16", {2, decode_as<std::int16_t>}},
       {"ushort", "uint16", {2, decode_as<std::uint16_t>}},
       {"int", "int32", {4, decode_as<std::int32_t>}},
       {"uint", "uint32", {4, decode_as<std::uint32_t>}},
       {"float", "float32", {4, decode_as<float>, true}},
       {"double", "float64", {8, decode_as<double>, true}}}};
  for (const Named& known : kTypes) {
    if (word == known.name || word == known.alias) return known.type;
  }
  text.fail("unknown type in the PLY header", "the file is damaged, export the mesh again");
}

void parse_property(MeshText& text, Header& header) {
  if (header.elements.empty()) {
    text.fail("property before the first element", "the file is damaged, export the mesh again");
  }
  Property property;
  std::string_view word = text.next_word();
  if (word == "list") {
    property.count = parse_type(text, text.next_word());
    word = text.next_word();
  }
  property.type = parse_type(text, word);
  property.name = text.next_word();
  if (property.count && property.count->real) {
    text.fail("a list's length cannot be a real number", "export the mesh again");
  }
  header.elements.back().properties.push_back(property);
}

[[nodiscard]] Encoding parse_encoding(MeshText& text) {
  const std::string_view word = text.next_word();
  if (word == "ascii") return Encoding::text;
  if (word == "binary_little_endian") return Encoding::little_endian;
  if (word == "binary_big_endian") return Encoding::big_endian;
  text.fail("unknown PLY format", "export the mesh as ascii or binary_little_endian");
}

[[nodiscard]] Header parse_header(MeshText& text) {
  Header header;
  bool has_format = false;
  while (text.next_line()) {
    const std::string_view keyword = text.next_word();
    if (keyword == "end_header") {
      if (!has_format) text.fail("the PLY header names no format", "export the mesh again");
      return header;
    }
    if (keyword == "format") {
      header.encoding = parse_encoding(text);
      has_format = true;
    } else if (keyword == "element") {
      Element element;
      element.name = text.next_word();
      const std::int64_t items = text.integer(text.next_word(), "number of elements");
      if (items < 0) text.fail("the number of elements is negative", "export the mesh again");
      element.items = static_cast<std::size_t>(items);
      header.elements.push_back(element);
    } else if (keyword == "property") {
      parse_property(text, header);
    } else if (keyword != "ply" && keyword != "comment" && keyword != "obj_info") {
      text.fail("unknown word in the PLY header", "the file is damaged, export the mesh again");
    }
  }
  text.fail_cut_short("end_header");
}

/// Values in the order of the file, from text or binary.
class Values {
 public:
  Values(const std::string& path, std::string_view bytes, const MeshText& after_header,
         Encoding encoding)
      : path_(path),
        bytes_(bytes),
        encoding_(encoding),
        position_(after_header.position()),
        text_(encoding == Encoding::text
                  ? MeshText(path, bytes, after_header.position(), after_header.line())
                  : MeshText(path, {})) {}

  /// The place of the value that was read last, as messages name it.
  [[nodiscard]] std::string place(const Element& element, std::size_t item) const {
    if (encoding_ == Encoding::text) return "line " + std::to_string(text_.line());
    return element.name + " " + std::to_string(item) + " (counted from 0)";
  }

  [[nodiscard]] double next(const Type& type, const Element& element, std::size_t item) {
    if (encoding_ == Encoding::text) {
      const std::string name = element.name + " " + std::to_string(item);
      const std::string_view word = by_lines_ ? text_.next_word() : text_.next_word_anywhere(name);
      if (word.empty()) text_.fail("the line ends within " + name, "export the mesh again");
      return text_.number(word, "value");
    }
    if (bytes_.size() - position_ < type.bytes) {
      refuse_file(path_,
                  "the file ends within " + element.name + " " + std::to_string(item) + " of " +
                      std::to_string(element.items),
                  "it was cut short, copy or export the mesh again");
    }
    std::array<char, 8> raw{};
    std::memcpy(raw.data(), bytes_.data() + position_, type.bytes);
    position_ += type.bytes;
    const bool big = encoding_ == Encoding::big_endian;
    if (big != (std::endian::native == std::endian::big)) {
      std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(type.bytes));
    }
    return type.decode(raw.data());
  }

  /// Where text is read next; nothing in a binary file, which cannot be entered in its middle.
  [[nodiscard]] std::optional<MeshText> text_here() const {
    return encoding_ == Encoding::text ? std::optional(text_) : std::nullopt;
  }

  /// From there on each item is a line, of which the rest may be anything.
  void read_by_lines(const MeshText& from) {
    text_ = from;
    by_lines_ = true;
  }

  void begin_item(const Element& element, std::size_t item) {
    if (by_lines_ && !text_.next_line()) {
      text_.fail_cut_short(element.name + " " + std::to_string(item));
    }
  }

  /// Refuses counts that the rest of the file cannot hold, before anything is allocated for them.
  void expect(const Element& element) const {
    std::size_t least = 0;
    for (const Property& property : element.properties) {
      const std::size_t binary = property.count ? property.count->bytes : property.type.bytes;
      least += encoding_ == Encoding::text ? 2 : binary;
    }
    // The last value of a text file may lack its line end.
    const std::size_t rest = bytes_.size() - position_ + 1;
    if (least > 0 && element.items > rest / least) {
      refuse_file(path_,
                  "the PLY header announces " + std::to_string(element.items) + " " + element.name +
                      " elements, more than the file holds",
                  "it was cut short or is damaged, copy or export the mesh again");
    }
  }

 private:
  const std::string& path_;
  std::string_view bytes_;
  Encoding encoding_;
  std::size_t position_;
  MeshText text_;
  bool by_lines_ = false;
};

/// A number that may be any, also none.
[[nodiscard]] std::string printed(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

class Reader {
 public:
  Reader(const std::string& path, Values& values) : path_(path), values_(values) {}

  void read_vertices(const Element& element) {
    std::array<std::size_t, 3> axes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name(1, static_cast<char>('x' + axis));
      const auto found =
          std::find_if(element.properties.begin(), element.properties.end(),
                       [&](const Property& p) { return p.name == name && !p.count; });
      if (found == element.properties.end()) {
        refuse_file(path_, "the PLY header gives vertices no property " + name);
      }
      axes[axis] = static_cast<std::size_t>(found - element.properties.begin());
    }
    soup.points.reserve(element.items);
    std::vector<double> item(element.properties.size());
    for (std::size_t i = 0; i < element.items; ++i) {
      for (std::size_t k = 0; k < item.size(); ++k) {
        item[k] = read_property(element.properties[k], element, i);
      }
      const Vector3 point(item[axes[0]], item[axes[1]], item[axes[2]]);
      if (!point.allFinite()) {
        refuse_at(element, i, "a coordinate is not finite",
                  "remove or mend this vertex and export the mesh again");
      }
      soup.points.push_back(point);
    }
  }

  /// The faces, or the strips of triangles. Values behind the indices may be others than the header
  /// says where each item is a line of text.
  void read_faces(const Element& element) {
    const auto corners =
        std::find_if(element.properties.begin(), element.properties.end(), [](const Property& p) {
          return p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
        });
    if (corners == element.properties.end()) {
      refuse_file(path_, "the PLY header gives faces no list vertex_indices");
    }
    const std::size_t wanted = static_cast<std::size_t>(corners - element.properties.begin()) + 1;
    const std::optional<MeshText> start = values_.text_here();
    const std::size_t before = soup.triangles.size();
    try {
      read_items(element, wanted, element.properties.size());
    } catch (const BakeError& problem) {
      if (!start || wanted == element.properties.size()) throw;
      soup.triangles.resize(before);
      values_.read_by_lines(*start);
      try {
        read_items(element, wanted, wanted);
      } catch (const BakeError&) {
        throw problem;
      }
      soup.notes.emplace_back(
          "Values behind the vertex indices are not those that the PLY header announces; they are "
          "not read.");
    }
  }

  void skip(const Element& element) {
    if (element.properties.empty()) return;  // no bytes, however many items are announced
    for (std::size_t i = 0; i < element.items; ++i) {
      for (const Property& property : element.properties) {
        (void)read_property(property, element, i);
      }
    }
  }

  PolygonSoup soup;

 private:
  /// Of each item so many properties, the last of `wanted` being the list of indices.
  void read_items(const Element& element, std::size_t wanted, std::size_t properties) {
    for (std::size_t i = 0; i < element.items; ++i) {
      values_.begin_item(element, i);
      for (std::size_t k = 0; k < properties; ++k) {
        (void)read_property(element.properties[k], element, i);
        if (k + 1 == wanted) polygon_ = list_;
      }
      if (element.name == strips_name) {
        add_strips(element, i);
      } else {
        add_face(element, i);
      }
    }
  }

  [[noreturn]] void refuse_at(const Element& element, std::size_t item, const std::string& cause,
                              const std::string& cure = "export the mesh again") const {
    refuse_file(path_ + ": " + values_.place(element, item), cause, cure);
  }

  /// The value, or the length of a list. The list's items are kept in list_.
  [[nodiscard]] double read_property(const Property& property, const Element& element,
                                     std::size_t item) {
    if (!property.count) return values_.next(property.type, element, item);
    const double length = values_.next(*property.count, element, item);
    if (length < 0) refuse_at(element, item, "negative length");
    list_.clear();
    for (std::size_t i = 0; static_cast<double>(i) < length; ++i) {
      list_.push_back(values_.next(property.type, element, item));
    }
    return length;
  }

  void add_face(const Element& element, std::size_t item) {
    if (polygon_.size() < 3) {
      refuse_at(element, item, "face with " + std::to_string(polygon_.size()) + " vertices",
                "a face needs 3 or more, export the mesh again");
    }
    indices_.clear();
    for (const double index : polygon_) indices_.push_back(vertex(index, element, item));
    add_polygon(indices_, soup);
  }

  /// Strips, each of which -1 ends. Every other triangle of a strip is reversed.
  void add_strips(const Element& element, std::size_t item) {
    indices_.clear();
    for (const double index : polygon_) {
      if (index == -1) {
        indices_.clear();
        continue;
      }
      indices_.push_back(vertex(index, element, item));
      const std::size_t count = indices_.size();
      if (count < 3) continue;
      Triangle triangle{indices_[count - 3], indices_[count - 2], indices_[count - 1]};
      if (count % 2 == 0) std::swap(triangle[0], triangle[1]);
      soup.triangles.push_back(triangle);
    }
  }

  [[nodiscard]] std::uint32_t vertex(double index, const Element& element, std::size_t item) const {
    if (!(index >= 0) || index >= static_cast<double>(soup.points.size()) ||
        index != std::floor(index)) {
      refuse_at(element, item,
                "vertex index " + printed(index) + " is out of range (" +
                    std::to_string(soup.points.size()) + " vertices)");
    }
    return static_cast<std::uint32_t>(index);
  }

  const std::string& path_;
  Values& values_;
  std::vector<double> list_, polygon_;
  std::vector<std::uint32_t> indices_;
};

/// The header is text even in a binary file: only this much may be searched for stray bytes.
[[nodiscard]] std::string_view header_bytes(std::string_view bytes) {
  const std::size_t end = bytes.find("end_header");
  if (end == std::string_view::npos) return bytes;
  const std::size_t line_end = bytes.find('\n', end);
  return bytes.substr(0, line_end == std::string_view::npos ? bytes.size() : line_end + 1);
}

}  // namespace

PolygonSoup read_ply(const std::string& path, std::string_view bytes) {
  MeshText text(path, header_bytes(bytes));
  if (!text.next_line() || text.next_word() != "ply") {
    text.fail("the first word is not ply", "the file is of another format, or damaged");
  }
  const Header header = parse_header(text);
  Values values(path, bytes, text, header.encoding);
  Reader reader(path, values);
  const auto has_faces = [](const Element& e) { return e.name == "face" || e.name == strips_name; };
  // What is behind the last element that matters may be broken.
  auto end = header.elements.end();
  while (end != header.elements.begin() && (end - 1)->name != "vertex" && !has_faces(*(end - 1))) {
    --end;
  }
  for (auto at = header.elements.begin(); at != end; ++at) {
    const Element& element = *at;
    values.expect(element);
    if (element.name == "vertex") {
      reader.read_vertices(element);
    } else if (has_faces(element)) {
      reader.read_faces(element);
    } else {
      reader.skip(element);
    }
  }
  return std::move(reader.soup);
}

}  // namespace spm::baker
