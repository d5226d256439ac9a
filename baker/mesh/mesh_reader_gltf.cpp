// SPDX-License-Identifier: GPL-3.0-or-later
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <meshoptimizer.h>
#include <openssl/evp.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "baker/base/bake_error.hpp"
#include "baker/mesh/mesh_reader.hpp"
#include "formats/files/json_text.hpp"
#include "formats/files/sha256.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::json;

/// A glTF 2.0 file, opened: what it describes, and the bytes of its buffers.
// NOLINTNEXTLINE(bugprone-exception-escape): a JSON value allocates while it is destroyed.
struct GltfFile {
  nlohmann::json json;
  std::vector<std::string> buffers;
  std::vector<std::string> companion_digests;  ///< SHA-256 of each buffer that is another file
};

constexpr std::string_view glb_mark = "glTF";
constexpr std::size_t glb_header = 12, chunk_header = 8;
constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;  // "JSON", "BIN"
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 32U;                // of all buffers

/// A number of the container, which is little-endian as all machines that bake are.
std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

struct Container {
  std::string_view json, binary;
  bool has_binary = false;
};

/// The chunks of a `.glb`; of a `.gltf` all is JSON.
Container opened(const std::string& path, std::string_view bytes) {
  Container found;
  if (!is_glb(bytes)) {
    found.json = bytes;
    return found;
  }
  if (bytes.size() < glb_header + chunk_header || word_at(bytes, 8) > bytes.size()) {
    refuse_file(path,
                "the file is cut short: of " +
                    (bytes.size() < glb_header ? std::string("its header")
                                               : std::to_string(word_at(bytes, 8)) + " bytes") +
                    " " + std::to_string(bytes.size()) + " are there");
  }
  if (const std::uint32_t version = word_at(bytes, 4); version != 2) {
    refuse_file(path, "it is glTF " + std::to_string(version), "export the mesh as glTF 2.0");
  }
  std::size_t at = glb_header;
  while (at + chunk_header <= bytes.size()) {
    const std::size_t length = word_at(bytes, at);
    const std::uint32_t kind = word_at(bytes, at + 4);
    at += chunk_header;
    if (length > bytes.size() - at) {
      refuse_file(path, "byte " + std::to_string(at) + ": a chunk of " + std::to_string(length) +
                            " bytes reaches beyond the end of the file");
    }
    if (kind == json_chunk && found.json.empty()) found.json = bytes.substr(at, length);
    if (kind == binary_chunk && !found.has_binary) {
      found.binary = bytes.substr(at, length);
      found.has_binary = true;
    }
    at += length;
  }
  return found;
}

Json parsed(const std::string& path, std::string_view text) {
  if (!is_shallow_json(text)) {
    refuse_file(path, "its JSON nests more than " + std::to_string(most_json_levels) + " levels");
  }
  try {
    Json json = Json::parse(text);
    const auto asset = json.is_object() ? json.find("asset") : json.end();
    const bool has_version = json.is_object() && asset != json.end() && asset->is_object() &&
                             asset->contains("version") && (*asset)["version"].is_string();
    if (!has_version) refuse_file(path, "it does not say which version of glTF it is");
    const auto version = (*asset)["version"].get<std::string>();
    if (!version.starts_with("2.")) {
      refuse_file(path, "it is glTF " + version, "export the mesh as glTF 2.0");
    }
    return json;
  } catch (const Json::parse_error& problem) {
    refuse_file(path, "byte " + std::to_string(problem.byte) + ": the JSON of the glTF is broken",
                "the file may be cut short, export the mesh again");
  } catch (const Json::out_of_range&) {
    refuse_file(path, "its JSON has a number that is larger than any that a computer knows");
  }
}

bool is_data(std::string_view uri) { return uri.starts_with("data:"); }

/// A reference with its %XX spelt out.
std::string decoded(const std::string& path, std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      text += uri[i];
      continue;
    }
    unsigned char value = 0;
    const char* const begin = uri.data() + i + 1;
    const char* const end = begin + std::min<std::size_t>(2, uri.size() - i - 1);
    if (std::from_chars(begin, end, value, 16).ptr != begin + 2 || value == 0) {
      refuse_file(path, "the name '" + std::string(uri) + "' of a buffer is broken");
    }
    text += static_cast<char>(value);
    i += 2;
  }
  return text;
}

/// Where the buffer of a reference lies.
std::string companion(const std::string& path, const std::string& uri, bool outside) {
  if (uri.find("://") != std::string::npos) {
    refuse_file(path, "a buffer is at " + uri + ", and nothing is fetched from elsewhere",
                "save the buffer beside the file");
  }
  const std::filesystem::path name(decoded(path, uri));
  const bool leaves = name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end();
  if (leaves && !outside) {
    refuse_file(path, "a buffer is at " + name.string() + ", which leads out of the file's folder",
                "save the buffer beside the file, or allow it with --outside-buffers");
  }
  return (std::filesystem::path(path).parent_path() / name).string();
}

/// The bytes of a `data:` reference.
std::string embedded(const std::string& path, std::string_view uri) {
  constexpr std::string_view mark = ";base64,";
  const std::size_t at = uri.find(mark);
  if (at == std::string_view::npos) refuse_file(path, "a buffer in the text is not in base64");
  const std::string_view code = uri.substr(at + mark.size());
  const std::size_t padding = code.size() - std::min(code.find('='), code.size());
  std::string bytes(code.size() / 4 * 3, '\0');
  const bool fits =
      code.size() % 4 == 0 && padding <= 2 && code.size() <= std::numeric_limits<int>::max();
  const int count = fits ? EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                           reinterpret_cast<const unsigned char*>(code.data()),
                                           static_cast<int>(code.size()))
                         : -1;
  if (count < 0) refuse_file(path, "the base64 of a buffer in the text is broken");
  bytes.resize(static_cast<std::size_t>(count) - padding);
  return bytes;
}

/// The references of the buffers; an empty one is the binary chunk.
std::vector<std::string> references(const std::string& path, const Json& json) {
  std::vector<std::string> found;
  const Json none = Json::array();
  const Json& buffers = json.contains("buffers") ? json["buffers"] : none;
  if (!buffers.is_array()) refuse_file(path, "'buffers' is no list");
  for (const Json& buffer : buffers) {
    const bool named = buffer.is_object() && buffer.contains("uri");
    if (!buffer.is_object() || (named && !buffer["uri"].is_string())) {
      refuse_file(path, "buffer " + std::to_string(found.size()) + " is none");
    }
    found.push_back(named ? buffer["uri"].get<std::string>() : std::string());
  }
  return found;
}

/// Whether a buffer only says how large its views are, which EXT_meshopt_compression has packed.
bool is_fallback(const Json& buffer) {
  static const Json::json_pointer mark("/extensions/EXT_meshopt_compression/fallback");
  return buffer.contains(mark) && buffer[mark] == true;
}

std::uint64_t stated_length(const std::string& path, const Json& buffer, std::size_t index) {
  const auto length = buffer.find("byteLength");
  if (length == buffer.end() || !length->is_number_unsigned() ||
      length->get<std::uint64_t>() > most_bytes) {
    refuse_file(path, "buffer " + std::to_string(index) + ": 'byteLength' is no length");
  }
  return length->get<std::uint64_t>();
}

/// Opens the bytes of a `.gltf` or a `.glb`, and its buffers.
GltfFile open_gltf(const std::string& path, std::string_view bytes, bool outside_buffers) {
  const Container container = opened(path, bytes);
  GltfFile file;
  file.json = parsed(path, container.json);
  std::uint64_t left = most_bytes;
  for (const std::string& uri : references(path, file.json)) {
    const std::size_t index = file.buffers.size();
    const std::string name = "buffer " + std::to_string(index);
    std::string content;
    if (uri.empty() && is_fallback(file.json["buffers"][index])) {
      file.buffers.emplace_back();
      continue;
    }
    if (uri.empty()) {
      if (!container.has_binary || index != 0) {
        refuse_file(path, name + " has no bytes, neither in this file nor in another");
      }
      content = container.binary;
    } else if (is_data(uri)) {
      content = embedded(path, uri);
    } else {
      const std::string place = companion(path, uri, outside_buffers);
      std::error_code unknown;
      const auto size = std::filesystem::file_size(place, unknown);
      if (!unknown && size > left) refuse_file(path, "its buffers have more than 4 GiB");
      Result<std::string> read = read_regular_file(place, "a buffer of a glTF");
      if (!read) {
        throw BakeError(read.error().code,
                        path + ": " + name + " is missing: " + read.error().message);
      }
      content = std::move(*read);
      file.companion_digests.push_back(sha256_bytes(content));
    }
    left -= std::min<std::uint64_t>(left, content.size());
    const std::uint64_t stated = stated_length(path, file.json["buffers"][index], index);
    if (content.size() < stated) {
      refuse_file(path, name + " is cut short: of " + std::to_string(stated) + " bytes " +
                            std::to_string(content.size()) + " are there");
    }
    content.resize(static_cast<std::size_t>(stated));
    file.buffers.push_back(std::move(content));
  }
  return file;
}

/// A view of a buffer as EXT_meshopt_compression describes it.
struct MeshoptView {
  std::string_view packed;
  std::uint64_t count = 0, stride = 0;
  std::string mode, filter;
};

/// Whether the decoder takes such numbers: it asserts what the extension demands.
bool is_allowed(const MeshoptView& view) {
  const std::uint64_t stride = view.stride;
  const std::uint64_t most = std::max(always_unpacked, most_growth * view.packed.size());
  if (stride == 0 || stride > 256 || view.count > most / stride) return false;
  if (view.mode == "ATTRIBUTES") return stride % 4 == 0;
  const bool triangles = view.mode == "TRIANGLES" && view.count % 3 == 0;
  return (triangles || view.mode == "INDICES") && (stride == 2 || stride == 4) &&
         (view.filter.empty() || view.filter == "NONE");
}

/// Undoes what made the values smaller before they were packed. False where it is not known.
bool undo_filter(const MeshoptView& view, std::string& bytes) {
  if (view.filter.empty() || view.filter == "NONE") return true;
  if (view.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
  } else if (view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) {
    meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
  } else if (view.filter == "QUATERNION" && view.stride == 8) {
    meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
  } else {
    return false;
  }
  return true;
}

/// Whether what the data announces is at most `most`: the decoder makes room for it unseen.
bool announces_at_most(std::string_view packed, std::uint64_t most) {
  draco::DecoderBuffer buffer;
  buffer.Init(packed.data(), packed.size());
  draco::DracoHeader header;
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return false;
  // glTF asks for version 2.2, from which on numbers are written as below.
  if (header.version_major != 2 || header.version_minor < 2) return false;
  buffer.set_bitstream_version(
      static_cast<std::uint16_t>(header.version_major << 8U | header.version_minor));
  draco::GeometryMetadata skipped;
  if ((header.flags & METADATA_FLAG_MASK) != 0 &&
      !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &skipped)) {
    return false;
  }
  std::uint8_t traversal = 0;
  std::uint32_t one = 0, other = 0;  // faces, and vertices or points
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING && !buffer.Decode(&traversal)) {
    return false;
  }
  return draco::DecodeVarint(&one, &buffer) && draco::DecodeVarint(&other, &buffer) &&
         one <= most && other <= most;
}

/// What such a view unpacks to: count times stride bytes. Nothing where it is broken, or where more
/// than 64 MiB would come out that are 100 times as large as what is packed.
std::optional<std::string> unpack_meshopt(const MeshoptView& view) {
  if (!is_allowed(view)) return {};
  std::string bytes(view.count * view.stride, '\0');
  const auto* const packed = reinterpret_cast<const unsigned char*>(view.packed.data());
  int (*decode)(void*, std::size_t, std::size_t, const unsigned char*, std::size_t) =
      meshopt_decodeVertexBuffer;
  if (view.mode == "TRIANGLES") decode = meshopt_decodeIndexBuffer;
  if (view.mode == "INDICES") decode = meshopt_decodeIndexSequence;
  if (decode(bytes.data(), view.count, view.stride, packed, view.packed.size()) != 0 ||
      !undo_filter(view, bytes)) {
    return {};
  }
  return bytes;
}

struct DracoMesh {
  std::vector<Vector3> points;
  std::vector<Triangle> triangles;  ///< no index out of range
};

/// The mesh of KHR_draco_mesh_compression; `position` is its attribute's unique number. Nothing
/// where it is broken, or has more than `most` points or triangles.
std::optional<DracoMesh> unpack_draco(std::string_view packed, std::uint64_t position,
                                      std::uint64_t most) {
  if (!announces_at_most(packed, most) || position > std::numeric_limits<std::uint32_t>::max()) {
    return {};
  }
  draco::DecoderBuffer buffer;
  buffer.Init(packed.data(), packed.size());
  const auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return {};
  const draco::Mesh& mesh = *decoded.value();
  const draco::PointAttribute* const points =
      mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(position));
  if (points == nullptr || points->num_components() != 3 || mesh.num_points() > most) return {};
  DracoMesh found;
  found.points.resize(mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const auto value = points->mapped_index(draco::PointIndex(i));
    if (value.value() >= points->size() ||
        !points->ConvertValue<double, 3>(value, found.points[i].data())) {
      return {};
    }
  }
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
    const Triangle triangle{face[0].value(), face[1].value(), face[2].value()};
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.num_points()) return {};
    }
    found.triangles.push_back(triangle);
  }
  return found;
}

constexpr std::uint64_t most_unpacked = std::uint64_t{1} << 30U;  // bytes

std::size_t component_bytes(int type) {
  switch (type) {
    case 5120:  // signed and unsigned bytes
    case 5121:
      return 1;
    case 5122:  // 16 bits
    case 5123:
      return 2;
    case 5125:  // unsigned 32 bits, float
    case 5126:
      return 4;
    default:
      return 0;
  }
}

template <class T>
double integer_at(const char* at, bool normalized) {
  T value{};
  std::memcpy(&value, at, sizeof value);
  if (!normalized) return static_cast<double>(value);
  return std::max(-1.0, static_cast<double>(value) / std::numeric_limits<T>::max());
}

bool is_index(int type) { return type == 5121 || type == 5123 || type == 5125; }

/// Values of a buffer: `count` times `width` numbers of a component type, as glTF numbers them.
struct GltfValues {
  const char* first = nullptr;
  std::size_t count = 0, width = 0, stride = 0;
  int type = 0;
  bool normalized = false;
  std::shared_ptr<const std::string> own;  ///< what `first` points into, where no buffer has it

  [[nodiscard]] double at(std::size_t row, std::size_t column) const {
    const char* const place = first + row * stride + column * component_bytes(type);
    switch (type) {
      case 5120:
        return integer_at<std::int8_t>(place, normalized);
      case 5121:
        return integer_at<std::uint8_t>(place, normalized);
      case 5122:
        return integer_at<std::int16_t>(place, normalized);
      case 5123:
        return integer_at<std::uint16_t>(place, normalized);
      case 5125:
        return integer_at<std::uint32_t>(place, normalized);
      default: {
        float value = 0;
        std::memcpy(&value, place, sizeof value);
        return value;
      }
    }
  }
};

/// Lists, numbers and accessors of a glTF. All throw BakeError invalid_input, which names the
/// place.
class GltfAccessors {
 public:
  GltfAccessors(const std::string& path, std::string_view bytes, bool outside_buffers)
      : file_(open_gltf(path, bytes, outside_buffers)), path_(path) {}

  [[noreturn]] void refuse(const std::string& cause,
                           const std::string& cure = "export the mesh again") const {
    refuse_file(path_, cause, cure);
  }

  [[nodiscard]] const Json& list(const char* name) const {
    static const Json none = Json::array();
    const auto found = file_.json.find(name);
    if (found == file_.json.end()) return none;
    if (!found->is_array()) refuse(std::string("'") + name + "' is no list");
    return *found;
  }

  [[nodiscard]] const Json& item(const char* name, std::size_t index) const {
    const Json& all = list(name);
    if (index >= all.size() || !all[index].is_object()) {
      refuse(std::string("there is no ") + std::to_string(index) + " in '" + name + "', of " +
             std::to_string(all.size()));
    }
    return all[index];
  }

  /// What an extension says of an object; nothing where it is not there.
  [[nodiscard]] const Json* extension(const Json& object, const char* name) const {
    const auto all = object.find("extensions");
    if (all == object.end() || !all->is_object()) return nullptr;
    const auto found = all->find(name);
    return found != all->end() && found->is_object() ? &*found : nullptr;
  }

  /// A whole number of an object; `otherwise` where it is not there.
  [[nodiscard]] std::uint64_t number(const Json& object, const char* key,
                                     std::optional<std::uint64_t> otherwise,
                                     const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end() && otherwise) return *otherwise;
    if (found == object.end() || !found->is_number_unsigned()) {
      refuse(where + ": '" + key + "' is " +
             (found == object.end() ? "missing" : "no whole number from 0"));
    }
    return found->get<std::uint64_t>();
  }

  /// Numbers of an object, so many; nothing where they are not there.
  [[nodiscard]] std::optional<std::vector<double>> numbers(const Json& object, const char* key,
                                                           std::size_t count,
                                                           const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    std::vector<double> values;
    if (found->is_array()) {
      for (const Json& value : *found) {
        if (value.is_number()) values.push_back(value.get<double>());
      }
    }
    if (values.size() != count) {
      refuse(where + ": '" + key + "' are not " + std::to_string(count) + " numbers");
    }
    return values;
  }

  /// The numbers that an accessor names, all of which are there. `counted`: their count alone,
  /// where they would have to be made first.
  [[nodiscard]] GltfValues values_of(std::size_t index, std::size_t width, const std::string& where,
                                     bool counted) {
    const Json& accessor = item("accessors", index);
    const std::string place = where + ", accessor " + std::to_string(index);
    const auto type = accessor.find("type");
    if (type == accessor.end() ||
        *type != (width == 1 ? "SCALAR" : "VEC" + std::to_string(width))) {
      refuse(place + " is of another type");
    }
    GltfValues values;
    values.count = number(accessor, "count", {}, place);
    values.width = width;
    values.type = static_cast<int>(number(accessor, "componentType", {}, place));
    const auto normalized = accessor.find("normalized");
    values.normalized = normalized != accessor.end() && *normalized == true;
    if (component_bytes(values.type) == 0 || (width == 1 && !is_index(values.type))) {
      refuse(place + ": component type " + std::to_string(values.type) + " is none of its kind");
    }
    const auto sparse = accessor.find("sparse");
    const bool has_sparse = sparse != accessor.end() && sparse->is_object();
    if (accessor.contains("bufferView")) {
      find_values(accessor, place, values);
    } else if (!has_sparse) {
      refuse(place + " has no values: neither 'bufferView' nor 'sparse' names any");
    }
    if (has_sparse && !counted) add_sparse(*sparse, place, values);
    return values;
  }

  /// The bytes of a view, unpacked.
  [[nodiscard]] std::string_view view_bytes(std::size_t index, const std::string& place) {
    const Json& view = item("bufferViews", index);
    const Json* const packed = extension(view, "EXT_meshopt_compression");
    if (packed == nullptr) return range(view, place);
    const auto known = unpacked_.find(index);
    if (known != unpacked_.end()) return known->second;
    const std::string where = place + ", bufferView " + std::to_string(index);
    return unpacked_.emplace(index, unpacked(*packed, where)).first->second;
  }

 protected:
  GltfFile file_;

 private:
  /// The bytes that a view names, as its buffer has them.
  [[nodiscard]] std::string_view range(const Json& view, const std::string& place) const {
    const std::uint64_t buffer = number(view, "buffer", {}, place);
    if (buffer >= file_.buffers.size()) {
      refuse(place + ": there is no buffer " + std::to_string(buffer));
    }
    const std::string_view bytes = file_.buffers[buffer];
    const std::uint64_t start = number(view, "byteOffset", 0, place),
                        length = number(view, "byteLength", {}, place);
    if (start > bytes.size() || length > bytes.size() - start) {
      refuse(place + ": " + std::to_string(length) + " bytes from byte " + std::to_string(start) +
             " are more than buffer " + std::to_string(buffer) + " has");
    }
    return bytes.substr(start, length);
  }

  [[nodiscard]] std::string unpacked(const Json& packed, const std::string& place) {
    const auto text = [&](const char* key) {
      const auto found = packed.find(key);
      return found != packed.end() && found->is_string() ? found->get<std::string>()
                                                         : std::string();
    };
    std::optional<std::string> bytes =
        unpack_meshopt({.packed = range(packed, place),
                        .count = number(packed, "count", {}, place),
                        .stride = number(packed, "byteStride", {}, place),
                        .mode = text("mode"),
                        .filter = text("filter")});
    if (!bytes) refuse(place + ": what EXT_meshopt_compression has packed is broken");
    unpacked_bytes_ += bytes->size();
    // Many views may name the same few bytes.
    if (unpacked_bytes_ > most_unpacked) {
      refuse(place + ": with it more than " + std::to_string(most_unpacked) +
                 " bytes are unpacked, which cannot be baked",
             "export a coarser mesh");
    }
    return std::move(*bytes);
  }

  /// Finds where the values of an accessor, or of its sparse part, begin.
  void find_values(const Json& object, const std::string& place, GltfValues& values) {
    const std::size_t size = component_bytes(values.type) * values.width;
    const std::size_t index = number(object, "bufferView", {}, place);
    const std::string_view bytes = view_bytes(index, place);
    const Json& view = item("bufferViews", index);
    values.stride = number(view, "byteStride", size, place);
    const std::uint64_t offset = number(object, "byteOffset", 0, place);
    if (values.stride < size || offset > bytes.size() ||
        (values.count > 0 && (bytes.size() - offset < size ||
                              (bytes.size() - offset - size) / values.stride < values.count - 1))) {
      refuse(place + ": " + std::to_string(values.count) + " values are more than buffer " +
             std::to_string(number(view, "buffer", {}, place)) + " has");
    }
    values.first = bytes.data() + offset;
  }

  /// Copies the values and replaces those that the sparse part names; values of no buffer are 0.
  void add_sparse(const Json& sparse, const std::string& place, GltfValues& values) {
    const std::size_t size = component_bytes(values.type) * values.width;
    const auto part = [&](const char* key) -> const Json& {
      const auto found = sparse.find(key);
      if (found == sparse.end() || !found->is_object()) {
        refuse(place + ": the '" + std::string(key) + "' of 'sparse' are missing");
      }
      return *found;
    };
    GltfValues indices, replaced = values;
    indices.count = replaced.count = number(sparse, "count", {}, place);
    indices.width = 1;
    indices.type = static_cast<int>(number(part("indices"), "componentType", {}, place));
    if (!is_index(indices.type)) refuse(place + ": the 'indices' of 'sparse' are no indices");
    find_values(part("indices"), place, indices);
    find_values(part("values"), place, replaced);
    std::string bytes(values.count * size, '\0');
    for (std::size_t i = 0; values.first != nullptr && i < values.count; ++i) {
      std::memcpy(bytes.data() + i * size, values.first + i * values.stride, size);
    }
    for (std::size_t i = 0; i < indices.count; ++i) {
      const auto index = static_cast<std::size_t>(indices.at(i, 0));
      if (index >= values.count) {
        refuse(place + ": index " + std::to_string(index) + " of 'sparse' is out of range (" +
               std::to_string(values.count) + " values)");
      }
      std::memcpy(bytes.data() + index * size, replaced.first + i * replaced.stride, size);
    }
    values.own = std::make_shared<const std::string>(std::move(bytes));
    values.first = values.own->data();
    values.stride = size;
  }

  const std::string& path_;
  std::map<std::size_t, std::string> unpacked_;  ///< by the view
  std::uint64_t unpacked_bytes_ = 0;
};

using Transform = Eigen::Affine3d;

constexpr int strip_mode = 5, fan_mode = 6, triangles_mode = 4;
constexpr std::array<std::string_view, 4> read_extensions{
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing"};
/// Extensions that change how a surface looks and not where it is begin so.
constexpr std::array<std::string_view, 8> looks{"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                "MSFT_texture_",  "KHR_lights_",  "EXT_lights_",
                                                "MSFT_packing",   "KHR_xmp"};

class Reader : private GltfAccessors {
 public:
  using GltfAccessors::GltfAccessors;

  PolygonSoup read() {
    refuse_unread_extensions();
    add_all();
    counting_ = false;
    soup_.points.reserve(points_);
    soup_.triangles.reserve(triangles_);
    add_all();
    soup_.companion_digests = std::move(file_.companion_digests);
    soup_.unit = 1;  // by the format
    add_notes();
    return std::move(soup_);
  }

 private:
  /// Everything that the file shows. While counting, its vertices and triangles alone, so that too
  /// many are refused before any is made.
  void add_all() {
    visited_.assign(list("nodes").size(), false);
    if (!list("nodes").empty()) return walk();
    for (std::size_t i = 0; i < list("meshes").size(); ++i) add_mesh(i, Transform::Identity());
  }

  void refuse_unread_extensions() const {
    for (const Json& name : list("extensionsRequired")) {
      const std::string text = name.is_string() ? name.get<std::string>() : name.dump();
      const bool known = std::find(read_extensions.begin(), read_extensions.end(), text) !=
                             read_extensions.end() ||
                         std::any_of(looks.begin(), looks.end(), [&](std::string_view start) {
                           return text.starts_with(start);
                         });
      if (!known) {
        refuse("it needs the extension " + text + ", which is not read",
               "export the mesh without that extension");
      }
    }
  }

  /// Where the nodes begin: those of the scene that is shown, or all that have no parent.
  std::vector<std::size_t> roots() const {
    std::vector<std::size_t> found;
    if (!list("scenes").empty()) {
      const std::size_t scene = number(file_.json, "scene", 0, "the file");
      return children(item("scenes", scene), "nodes", "scene " + std::to_string(scene));
    }
    std::vector<bool> is_child(list("nodes").size(), false);
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      for (const std::size_t child :
           children(item("nodes", i), "children", "node " + std::to_string(i))) {
        if (child < is_child.size()) is_child[child] = true;
      }
    }
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i]) found.push_back(i);
    }
    return found;
  }

  std::vector<std::size_t> children(const Json& object, const char* key,
                                    const std::string& where) const {
    std::vector<std::size_t> found;
    const auto all = object.find(key);
    if (all == object.end()) return found;
    if (!all->is_array()) refuse(where + ": '" + key + "' is no list");
    for (const Json& child : *all) {
      if (!child.is_number_unsigned()) refuse(where + ": '" + key + "' has what is no node");
      found.push_back(child.get<std::size_t>());
    }
    return found;
  }

  /// Goes through the nodes without recursion, which a deep file would exhaust.
  void walk() {
    struct Step {
      std::size_t node;
      Transform above;
    };
    std::vector<Step> steps;
    const std::vector<std::size_t> first = roots();
    for (auto node = first.rbegin(); node != first.rend(); ++node) {
      steps.push_back({*node, Transform::Identity()});
    }
    while (!steps.empty()) {
      const Step step = steps.back();
      steps.pop_back();
      const std::string where = "node " + std::to_string(step.node);
      const Json& node = item("nodes", step.node);
      if (visited_[step.node]) refuse(where + " hangs below two nodes, or below itself");
      visited_[step.node] = true;
      const Transform here = step.above * transform_of(node, where);
      if (!here.matrix().allFinite()) refuse(where + " is moved or scaled beyond all numbers");
      if (node.contains("mesh")) add_meshes(node, where, here);
      const std::vector<std::size_t> below = children(node, "children", where);
      for (auto child = below.rbegin(); child != below.rend(); ++child) {
        steps.push_back({*child, here});
      }
    }
  }

  Transform transform_of(const Json& node, const std::string& where) const {
    Transform transform = Transform::Identity();
    if (const auto matrix = numbers(node, "matrix", 16, where)) {
      transform.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix->data());
      if (transform.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
        refuse(where + ": 'matrix' is no affine one");
      }
      return transform;
    }
    if (const auto t = numbers(node, "translation", 3, where)) {
      transform.translate(Vector3((*t)[0], (*t)[1], (*t)[2]));
    }
    if (const auto r = numbers(node, "rotation", 4, where)) {
      Eigen::Quaterniond turn((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
      if (!(turn.norm() > 0)) refuse(where + ": 'rotation' is no quaternion");
      transform.rotate(turn.normalized());
    }
    if (const auto s = numbers(node, "scale", 3, where)) {
      transform.scale(Vector3((*s)[0], (*s)[1], (*s)[2]));
    }
    return transform;
  }

  /// The mesh of a node, or as many as EXT_mesh_gpu_instancing places below it.
  void add_meshes(const Json& node, const std::string& where, const Transform& here) {
    const std::size_t mesh = number(node, "mesh", {}, where);
    if (!counting_) {
      const Eigen::Index rank = Eigen::FullPivLU<Eigen::Matrix3d>(here.linear()).rank();
      without_area_ += rank < 2 ? 1 : 0;
      flat_ += rank == 2 ? 1 : 0;
      skinned_ += node.contains("skin") ? 1 : 0;
    }
    const Json* const instances = extension(node, "EXT_mesh_gpu_instancing");
    if (instances == nullptr) return add_mesh(mesh, here);
    const auto attributes = instances->find("attributes");
    if (attributes == instances->end() || !attributes->is_object()) {
      refuse(where + ": its instances have no attributes");
    }
    const auto read = [&](const char* key, std::size_t width) {
      if (!attributes->contains(key)) return GltfValues{};
      return values_of(number(*attributes, key, {}, where), width, where, false);
    };
    const GltfValues moved = read("TRANSLATION", 3), turned = read("ROTATION", 4),
                     scaled = read("SCALE", 3);
    const std::size_t count = std::max({moved.count, turned.count, scaled.count});
    for (const GltfValues* values : {&moved, &turned, &scaled}) {
      if (values->first != nullptr && values->count != count) {
        refuse(where + ": the attributes of its instances are not of one number");
      }
    }
    const auto vector = [](const GltfValues& values, std::size_t i) {
      return Vector3(values.at(i, 0), values.at(i, 1), values.at(i, 2));
    };
    for (std::size_t i = 0; i < count; ++i) {
      Transform place = here;
      if (moved.first != nullptr) place.translate(vector(moved, i));
      if (turned.first != nullptr) {
        const Eigen::Quaterniond turn(turned.at(i, 3), turned.at(i, 0), turned.at(i, 1),
                                      turned.at(i, 2));
        if (!(turn.norm() > 0)) refuse(where + ": the rotation of an instance is no quaternion");
        place.rotate(turn.normalized());
      }
      if (scaled.first != nullptr) place.scale(vector(scaled, i));
      add_mesh(mesh, place);
    }
  }

  void add_mesh(std::size_t index, const Transform& transform) {
    const std::string where = "mesh " + std::to_string(index);
    const Json& mesh = item("meshes", index);
    // A mesh without triangles is placed as often, and takes as long.
    if (++placed_ > 2 * most_points) refuse(where + " is placed too often", "export fewer parts");
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) refuse(where + " has no primitives");
    for (std::size_t i = 0; i < primitives->size(); ++i) {
      const std::string part = where + ", primitive " + std::to_string(i);
      if (!(*primitives)[i].is_object()) refuse(part + " is none");
      add_primitive((*primitives)[i], part, transform);
    }
  }

  void add_primitive(const Json& primitive, const std::string& where, const Transform& transform) {
    const std::uint64_t mode = number(primitive, "mode", triangles_mode, where);
    if (mode < triangles_mode || mode > fan_mode) return;  // points and lines
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object()) {
      refuse(where + " has no attributes");
    }
    const auto targets = primitive.find("targets");
    if (!counting_ && targets != primitive.end() && !targets->empty()) ++morphed_;
    const std::size_t position = number(*attributes, "POSITION", {}, where);
    const Json* const packed = extension(primitive, "KHR_draco_mesh_compression");
    // Beside what is packed there may be the same values as they are.
    if (packed != nullptr && !item("accessors", position).contains("bufferView")) {
      return add_draco(*packed, where, transform);
    }
    const GltfValues points = values_of(position, 3, where, counting_);
    std::optional<GltfValues> indices;
    if (primitive.contains("indices")) {
      indices = values_of(number(primitive, "indices", {}, where), 1, where, counting_);
    }
    const std::size_t base = soup_.points.size();
    const std::size_t corners = indices ? indices->count : points.count;
    if (counting_) return count(points.count, corners / (mode == triangles_mode ? 3 : 1), where);
    for (std::size_t i = 0; i < points.count; ++i) {
      add_point(Vector3(points.at(i, 0), points.at(i, 1), points.at(i, 2)), i, where, transform);
    }
    const auto corner = [&](std::size_t i) {
      const double index = indices ? indices->at(i, 0) : static_cast<double>(i);
      if (!(index < static_cast<double>(points.count))) {
        refuse(where + ": vertex index " + std::to_string(static_cast<std::uint64_t>(index)) +
               " is out of range (" + std::to_string(points.count) + " vertices)");
      }
      return static_cast<std::uint32_t>(base + static_cast<std::size_t>(index));
    };
    const bool mirrored = transform.linear().determinant() < 0;
    const std::size_t step = mode == triangles_mode ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners; i += step) {
      const bool odd = mode == strip_mode && i % 2 == 1;
      Triangle triangle{corner(mode == fan_mode ? 0 : i), corner(i + 1), corner(i + 2)};
      if (odd != mirrored) std::swap(triangle[1], triangle[2]);
      soup_.triangles.push_back(triangle);
    }
  }

  void add_draco(const Json& packed, const std::string& where, const Transform& transform) {
    const std::size_t view = number(packed, "bufferView", {}, where);
    const auto attributes = packed.find("attributes");
    if (attributes == packed.end() || !attributes->is_object()) {
      refuse(where + ": KHR_draco_mesh_compression names no attributes");
    }
    const std::optional<DracoMesh> mesh = unpack_draco(
        view_bytes(view, where), number(*attributes, "POSITION", {}, where), most_points);
    if (!mesh) refuse(where + ": what KHR_draco_mesh_compression has packed is broken");
    if (counting_) return count(mesh->points.size(), mesh->triangles.size(), where);
    const auto base = static_cast<std::uint32_t>(soup_.points.size());
    for (std::size_t i = 0; i < mesh->points.size(); ++i) {
      add_point(mesh->points[i], i, where, transform);
    }
    const bool mirrored = transform.linear().determinant() < 0;
    for (auto [a, b, c] : mesh->triangles) {
      if (mirrored) std::swap(b, c);
      soup_.triangles.push_back({base + a, base + b, base + c});
    }
  }

  void count(std::uint64_t points, std::uint64_t triangles, const std::string& where) {
    points_ += points;
    triangles_ += triangles;
    if (points_ > most_points || triangles_ > most_points) {
      refuse(where + ": with it the file has more than " + std::to_string(most_points) +
                 " vertices or triangles, which cannot be baked",
             "export fewer parts, or a coarser mesh");
    }
  }

  void add_point(const Vector3& point, std::size_t i, const std::string& where,
                 const Transform& transform) {
    soup_.points.push_back(transform * point);
    if (!soup_.points.back().allFinite()) {
      refuse(where + ": vertex " + std::to_string(i) + " has a coordinate that is no number");
    }
  }

  void add_notes() {
    const auto note = [&](const char* what, std::size_t count) {
      if (count > 0) soup_.notes.push_back(what + std::to_string(count) + ".");
    };
    note("Parts whose skin is not applied, so that their bind pose is baked: ", skinned_);
    note("Parts whose morph targets are not applied, so that their bind pose is baked: ", morphed_);
    note("Parts without area, since a node scales them to nothing: ", without_area_);
    note("Flat parts, since a node scales them by 0 in one direction: ", flat_);
  }

  PolygonSoup soup_;
  std::vector<bool> visited_;
  bool counting_ = true;
  std::uint64_t points_ = 0, triangles_ = 0;  ///< counted
  std::uint64_t placed_ = 0;                  ///< meshes, while counting and after it
  std::size_t skinned_ = 0, morphed_ = 0, without_area_ = 0, flat_ = 0;
};

}  // namespace

bool is_glb(std::string_view bytes) { return bytes.starts_with(glb_mark); }

bool resembles_gltf(std::string_view bytes) {
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && bytes[first] == '{' &&
         bytes.find("\"asset\"") != std::string_view::npos;
}

std::vector<std::string> gltf_companions(const std::string& path, std::string_view bytes,
                                         bool outside_buffers) {
  std::vector<std::string> files;
  for (const std::string& uri : references(path, parsed(path, opened(path, bytes).json))) {
    if (!uri.empty() && !is_data(uri)) files.push_back(companion(path, uri, outside_buffers));
  }
  return files;
}

PolygonSoup read_gltf(const std::string& path, std::string_view bytes, bool outside_buffers) {
  return Reader(path, bytes, outside_buffers).read();
}

}  // namespace spm::baker
