// SPDX-License-Identifier: GPL-3.0-or-later
#include <expat.h>
#include <zip.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <exception>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "baker/mesh/mesh_reader.hpp"

namespace spm::baker {
namespace {

using Transform = Eigen::Affine3d;

constexpr std::size_t most_placed = std::size_t{1} << 20U;
constexpr char separator = '|';  // of a name and its namespace
constexpr std::string_view core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
constexpr std::string_view production =
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
/// What else a file may need and gets: neither colours nor names of triangles move a surface.
constexpr std::array<std::string_view, 3> known_extensions{
    production, "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07"};

/// The parts of a package, which is a ZIP archive.
class Package {
 public:
  Package(const std::string& path, std::string_view bytes)
      : path_(path), left_(std::max(always_unpacked, most_growth * bytes.size())) {
    zip_error_t problem;
    zip_error_init(&problem);
    zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &problem);
    zip_t* const opened =
        source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &problem);
    if (opened == nullptr) {
      if (source != nullptr) zip_source_free(source);
      const std::string cause = zip_error_strerror(&problem);
      zip_error_fini(&problem);
      refuse_file(path_, "its ZIP archive cannot be opened (" + cause + ")",
                  "it may be cut short, copy or export the mesh again");
    }
    archive_.reset(opened);
  }

  /// The bytes of a part; together the parts may be 64 MiB, or 100 times what the file is.
  [[nodiscard]] std::string read(const std::string& name) {
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
        zip_fopen(archive_.get(), name.c_str(), ZIP_FL_NOCASE), &zip_fclose);
    if (!file) refuse_file(path_, "its part " + name + " cannot be read (" + cause() + ")");
    std::string bytes;
    std::array<char, 1U << 16U> block;
    zip_int64_t count = 0;
    while ((count = zip_fread(file.get(), block.data(), block.size())) > 0) {
      if (static_cast<std::size_t>(count) > left_) {
        refuse_file(path_,
                    "its parts are more than 100 times as large as the file, which no mesh is",
                    "unpack it yourself and look at it");
      }
      left_ -= static_cast<std::size_t>(count);
      bytes.append(block.data(), static_cast<std::size_t>(count));
    }
    if (count < 0) {
      refuse_file(path_, "its part " + name + " is damaged", "copy or export the mesh again");
    }
    return bytes;
  }

 private:
  [[nodiscard]] std::string cause() const {
    return zip_error_strerror(zip_get_error(archive_.get()));
  }

  const std::string& path_;
  std::size_t left_;
  std::unique_ptr<zip_t, void (*)(zip_t*)> archive_{nullptr, &zip_discard};
};

/// The attributes of an element, name and value by turns; those with a namespace as
/// "namespace|name".
using Attributes = const char**;

/// The value of one; null where it is not there.
[[nodiscard]] const char* find(Attributes attributes, std::string_view name) {
  for (; *attributes != nullptr; attributes += 2) {
    if (name == attributes[0]) return attributes[1];
  }
  return nullptr;
}

/// Walks through the elements of a part of XML. Errors name the part and the line.
class XmlPart {
 public:
  XmlPart(const std::string& path, std::string part)
      : part_(std::move(part)),
        place_(path + ": " + part_),
        parser_(XML_ParserCreateNS(nullptr, separator), &XML_ParserFree) {
    XML_SetUserData(parser_.get(), this);
    XML_SetStartElementHandler(parser_.get(), [](void* self, const char* name, const char** all) {
      static_cast<XmlPart*>(self)->guarded([&](XmlPart& xml) { xml.begin(name, all); });
    });
    XML_SetStartNamespaceDeclHandler(parser_.get(), [](void* self, const char* prefix,
                                                       const char* space) {
      if (prefix == nullptr || space == nullptr) return;
      static_cast<XmlPart*>(self)->guarded([&](XmlPart& xml) { xml.namespaces_[prefix] = space; });
    });
    XML_SetStartDoctypeDeclHandler(
        parser_.get(), [](void* self, const char*, const char*, const char*, int) {
          static_cast<XmlPart*>(self)->guarded(
              [](XmlPart& xml) { xml.fail("a document type, which 3MF does not allow"); });
        });
  }
  XmlPart(const XmlPart&) = delete;
  XmlPart& operator=(const XmlPart&) = delete;
  virtual ~XmlPart() = default;

  void parse(std::string_view bytes) {
    constexpr std::size_t block = 1U << 20U;
    for (std::size_t at = 0; at <= bytes.size(); at += block) {
      const std::string_view some = bytes.substr(at, block);
      const bool last = at + block > bytes.size();
      const XML_Status status = XML_Parse(parser_.get(), some.data(), static_cast<int>(some.size()),
                                          static_cast<int>(last));
      if (problem_) std::rethrow_exception(problem_);
      if (status != XML_STATUS_OK) {
        fail(std::string("broken XML (") + XML_ErrorString(XML_GetErrorCode(parser_.get())) + ")");
      }
    }
  }

 protected:
  virtual void begin(std::string_view name, Attributes attributes) = 0;

  [[noreturn]] void fail(const std::string& cause,
                         const std::string& cure = "export the mesh again") const {
    refuse_file(place_,
                "line " + std::to_string(XML_GetCurrentLineNumber(parser_.get())) + ": " + cause,
                cure);
  }

  [[nodiscard]] const char* text(Attributes attributes, const char* name) const {
    const char* const found = find(attributes, name);
    if (found == nullptr) fail(std::string("'") + name + "' is missing");
    return found;
  }

  template <class T>
  [[nodiscard]] T number(std::string_view word, const char* name) const {
    T value{};
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || value - value != T{}) {
      fail(std::string("'") + name + "' is no number that can be");
    }
    return value;
  }

  template <class T>
  [[nodiscard]] T number(Attributes attributes, const char* name) const {
    return number<T>(std::string_view(text(attributes, name)), name);
  }

  const std::string part_;
  std::map<std::string, std::string> namespaces_;  ///< by prefix

 private:
  /// Exceptions wait until the parser, which is C, has returned.
  template <class Do>
  void guarded(const Do& action) {
    if (problem_) return;
    try {
      action(*this);
    } catch (...) {
      problem_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  std::string place_;
  std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser_;
  std::exception_ptr problem_;
};

/// Where the package says that its model is.
class Relations : public XmlPart {
 public:
  explicit Relations(const std::string& path) : XmlPart(path, "_rels/.rels") {}

  std::string model;

 protected:
  void begin(std::string_view name, Attributes attributes) override {
    if (!name.ends_with("|Relationship")) return;
    if (!std::string_view(text(attributes, "Type")).ends_with("/3dmodel")) return;
    model = text(attributes, "Target");
  }
};

/// An object of a part, by the part's name and its own number.
using ObjectName = std::pair<std::string, std::uint32_t>;

struct Placed {
  ObjectName object;
  Transform transform;
};

struct Object {
  std::vector<Vector3> points;
  std::vector<Triangle> triangles;
  std::vector<Placed> components;
};

/// A part's name in the archive.
[[nodiscard]] std::string part_name(const std::string& name) {
  return name.starts_with('/') ? name.substr(1) : name;
}

class Model : public XmlPart {
 public:
  Model(const std::string& path, const std::string& part, std::map<ObjectName, Object>& objects)
      : XmlPart(path, part), objects_(objects) {}

  std::vector<Placed> items;
  double unit = 1e-3;  ///< m

 protected:
  void begin(std::string_view name, Attributes attributes) override {
    if (!name.starts_with(core) || name.size() <= core.size() || name[core.size()] != separator) {
      return;
    }
    name.remove_prefix(core.size() + 1);
    if (name == "vertex") {
      object().points.emplace_back(number<double>(attributes, "x"), number<double>(attributes, "y"),
                                   number<double>(attributes, "z"));
    } else if (name == "triangle") {
      object().triangles.push_back(
          {corner(attributes, "v1"), corner(attributes, "v2"), corner(attributes, "v3")});
    } else if (name == "object") {
      const auto [at, added] =
          objects_.try_emplace({part_, number<std::uint32_t>(attributes, "id")});
      if (!added) fail("object " + std::to_string(at->first.second) + " is there twice");
      object_ = &at->second;
    } else if (name == "component") {
      object().components.push_back(placed(attributes));
    } else if (name == "item") {
      items.push_back(placed(attributes));
    } else if (name == "model") {
      read_head(attributes);
    }
  }

 private:
  [[nodiscard]] Object& object() const {
    if (object_ == nullptr) fail("a part of a mesh outside any object");
    return *object_;
  }

  [[nodiscard]] std::uint32_t corner(Attributes attributes, const char* name) const {
    const auto index = number<std::uint32_t>(attributes, name);
    if (index >= object().points.size()) {
      fail("vertex index " + std::to_string(index) + " is out of range (" +
           std::to_string(object().points.size()) + " vertices)");
    }
    return index;
  }

  [[nodiscard]] Placed placed(Attributes attributes) const {
    static const std::string path_key = std::string(production) + separator + "path";
    const char* const part = find(attributes, path_key);
    Placed found{
        {part == nullptr ? part_ : part_name(part), number<std::uint32_t>(attributes, "objectid")},
        Transform::Identity()};
    const char* const transform = find(attributes, "transform");
    if (transform == nullptr) return found;
    // Four rows of three, which points are multiplied with from the left.
    std::string_view rest = transform;
    for (int i = 0; i < 12; ++i) {
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
      const std::size_t end = std::min(rest.find_first_of(" \t\r\n"), rest.size());
      found.transform.matrix()(i % 3, i / 3) = number<double>(rest.substr(0, end), "transform");
      rest.remove_prefix(end);
    }
    return found;
  }

  void read_head(Attributes attributes) {
    struct Unit {
      std::string_view name;
      double metres;
    };
    static constexpr std::array<Unit, 6> units{{{"micron", 1e-6},
                                                {"millimeter", 1e-3},
                                                {"centimeter", 1e-2},
                                                {"inch", 0.0254},
                                                {"foot", 0.3048},
                                                {"meter", 1}}};
    const char* const named = find(attributes, "unit");
    const auto* const found = std::find_if(units.begin(), units.end(), [&](const Unit& known) {
      return known.name == (named == nullptr ? "millimeter" : named);
    });
    if (found == units.end()) fail("a unit that 3MF does not know", "give --unit");
    unit = found->metres;
    const char* const needed = find(attributes, "requiredextensions");
    std::string_view rest = needed == nullptr ? "" : needed;
    while (rest.find_first_not_of(' ') != std::string_view::npos) {
      rest.remove_prefix(rest.find_first_not_of(' '));
      const std::string prefix(rest.substr(0, rest.find(' ')));
      rest.remove_prefix(prefix.size());
      const std::string& space = namespaces_[prefix];
      if (std::find(known_extensions.begin(), known_extensions.end(), space) ==
          known_extensions.end()) {
        fail("it needs the extension " + (space.empty() ? prefix : space) + ", which is not read",
             "export the mesh without that extension");
      }
    }
  }

  std::map<ObjectName, Object>& objects_;
  Object* object_ = nullptr;
};

class Reader {
 public:
  Reader(const std::string& path, std::string_view bytes) : path_(path), package_(path, bytes) {}

  [[nodiscard]] PolygonSoup read() {
    Relations relations(path_);
    relations.parse(package_.read("_rels/.rels"));
    if (relations.model.empty()) refuse_file(path_, "its package names no 3D model");
    const Parsed root = parsed(part_name(relations.model));
    soup_.unit = root.unit;
    place(root.items);
    return std::move(soup_);
  }

 private:
  struct Parsed {
    std::vector<Placed> items;
    double unit;
  };

  Parsed parsed(const std::string& part) {
    Model model(path_, part, objects_);
    parts_.insert(part);
    model.parse(package_.read(part));
    return {std::move(model.items), model.unit};
  }

  /// Places the objects of the build, and what they are made of, without recursion.
  void place(const std::vector<Placed>& items) {
    std::vector<Placed> steps(items.rbegin(), items.rend());
    std::size_t placed = steps.size();
    while (!steps.empty()) {
      const Placed step = std::move(steps.back());
      steps.pop_back();
      const Object& object = object_of(step.object);
      add(object, step.transform);
      placed += object.components.size();
      if (placed > most_placed) {
        refuse_file(path_, "its build has more than a million parts, or a part is one of its own",
                    "export fewer parts");
      }
      for (auto at = object.components.rbegin(); at != object.components.rend(); ++at) {
        steps.push_back({at->object, step.transform * at->transform});
      }
    }
  }

  const Object& object_of(const ObjectName& name) {
    if (!parts_.contains(name.first)) (void)parsed(name.first);
    const auto found = objects_.find(name);
    if (found == objects_.end()) {
      refuse_file(path_, "there is no object " + std::to_string(name.second) + " in " + name.first);
    }
    return found->second;
  }

  void add(const Object& object, const Transform& transform) {
    const std::size_t base = soup_.points.size();
    if (base + object.points.size() > most_points ||
        soup_.triangles.size() + object.triangles.size() > most_points) {
      refuse_file(path_,
                  "it has more than " + std::to_string(most_points) +
                      " vertices or triangles, which cannot be baked",
                  "export fewer parts, or a coarser mesh");
    }
    for (const Vector3& point : object.points) {
      soup_.points.push_back(transform * point);
      if (!soup_.points.back().allFinite()) {
        refuse_file(path_, "a part is moved or scaled beyond all numbers");
      }
    }
    const bool mirrored = transform.linear().determinant() < 0;
    const auto first = static_cast<std::uint32_t>(base);
    for (auto [a, b, c] : object.triangles) {
      if (mirrored) std::swap(b, c);
      soup_.triangles.push_back({first + a, first + b, first + c});
    }
  }

  const std::string& path_;
  Package package_;
  std::map<ObjectName, Object> objects_;
  std::set<std::string> parts_;  ///< that were read
  PolygonSoup soup_;
};

}  // namespace

bool resembles_3mf(std::string_view bytes) {
  return bytes.starts_with("PK\3\4") && bytes.find(".model") != std::string_view::npos &&
         bytes.find("_rels/.rels") != std::string_view::npos;
}

PolygonSoup read_3mf(const std::string& path, std::string_view bytes) {
  return Reader(path, bytes).read();
}

}  // namespace spm::baker
