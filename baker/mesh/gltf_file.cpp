// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/gltf_file.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <system_error>

#include "baker/base/bake_error.hpp"
#include "formats/files/json_text.hpp"
#include "formats/files/sha256.hpp"
#include "formats/files/text_file.hpp"

namespace spm::baker {
namespace {

using Json = nlohmann::json;

constexpr std::string_view glb_mark = "glTF";
constexpr std::size_t glb_header = 12, chunk_header = 8;
constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;  // "JSON", "BIN"
constexpr std::uint64_t most_bytes = std::uint64_t{1} << 32U;                // of all buffers

[[noreturn]] void refuse(const std::string& path, const std::string& cause,
                         const std::string& cure = "export the mesh again") {
  throw BakeError(ExitCode::invalid_input, path + ": " + cause + "; " + cure);
}

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
    refuse(path, "the file is cut short: of " +
                     (bytes.size() < glb_header ? std::string("its header")
                                                : std::to_string(word_at(bytes, 8)) + " bytes") +
                     " " + std::to_string(bytes.size()) + " are there");
  }
  if (const std::uint32_t version = word_at(bytes, 4); version != 2) {
    refuse(path, "it is glTF " + std::to_string(version), "export the mesh as glTF 2.0");
  }
  std::size_t at = glb_header;
  while (at + chunk_header <= bytes.size()) {
    const std::size_t length = word_at(bytes, at);
    const std::uint32_t kind = word_at(bytes, at + 4);
    at += chunk_header;
    if (length > bytes.size() - at) {
      refuse(path, "byte " + std::to_string(at) + ": a chunk of " + std::to_string(length) +
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
    refuse(path, "its JSON nests more than " + std::to_string(most_json_levels) + " levels");
  }
  try {
    Json json = Json::parse(text);
    const auto asset = json.is_object() ? json.find("asset") : json.end();
    const bool has_version = json.is_object() && asset != json.end() && asset->is_object() &&
                             asset->contains("version") && (*asset)["version"].is_string();
    if (!has_version) refuse(path, "it does not say which version of glTF it is");
    const auto version = (*asset)["version"].get<std::string>();
    if (!version.starts_with("2.")) {
      refuse(path, "it is glTF " + version, "export the mesh as glTF 2.0");
    }
    return json;
  } catch (const Json::parse_error& problem) {
    refuse(path, "byte " + std::to_string(problem.byte) + ": the JSON of the glTF is broken",
           "the file may be cut short, export the mesh again");
  } catch (const Json::out_of_range&) {
    refuse(path, "its JSON has a number that is larger than any that a computer knows");
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
      refuse(path, "the name '" + std::string(uri) + "' of a buffer is broken");
    }
    text += static_cast<char>(value);
    i += 2;
  }
  return text;
}

/// Where the buffer of a reference lies.
std::string companion(const std::string& path, const std::string& uri, bool outside) {
  if (uri.find("://") != std::string::npos) {
    refuse(path, "a buffer is at " + uri + ", and nothing is fetched from elsewhere",
           "save the buffer beside the file");
  }
  const std::filesystem::path name(decoded(path, uri));
  const bool leaves = name.is_absolute() || std::find(name.begin(), name.end(), "..") != name.end();
  if (leaves && !outside) {
    refuse(path, "a buffer is at " + name.string() + ", which leads out of the file's folder",
           "save the buffer beside the file, or allow it with --outside-buffers");
  }
  return (std::filesystem::path(path).parent_path() / name).string();
}

/// The bytes of a `data:` reference.
std::string embedded(const std::string& path, std::string_view uri) {
  constexpr std::string_view mark = ";base64,";
  const std::size_t at = uri.find(mark);
  if (at == std::string_view::npos) refuse(path, "a buffer in the text is not in base64");
  const std::string_view code = uri.substr(at + mark.size());
  const std::size_t padding = code.size() - std::min(code.find('='), code.size());
  std::string bytes(code.size() / 4 * 3, '\0');
  const bool fits =
      code.size() % 4 == 0 && padding <= 2 && code.size() <= std::numeric_limits<int>::max();
  const int count = fits ? EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                           reinterpret_cast<const unsigned char*>(code.data()),
                                           static_cast<int>(code.size()))
                         : -1;
  if (count < 0) refuse(path, "the base64 of a buffer in the text is broken");
  bytes.resize(static_cast<std::size_t>(count) - padding);
  return bytes;
}

/// The references of the buffers; an empty one is the binary chunk.
std::vector<std::string> references(const std::string& path, const Json& json) {
  std::vector<std::string> found;
  const Json none = Json::array();
  const Json& buffers = json.contains("buffers") ? json["buffers"] : none;
  if (!buffers.is_array()) refuse(path, "'buffers' is no list");
  for (const Json& buffer : buffers) {
    const bool named = buffer.is_object() && buffer.contains("uri");
    if (!buffer.is_object() || (named && !buffer["uri"].is_string())) {
      refuse(path, "buffer " + std::to_string(found.size()) + " is none");
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
    refuse(path, "buffer " + std::to_string(index) + ": 'byteLength' is no length");
  }
  return length->get<std::uint64_t>();
}

}  // namespace

bool is_glb(std::string_view bytes) { return bytes.starts_with(glb_mark); }

bool resembles_gltf(std::string_view bytes) {
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && bytes[first] == '{' &&
         bytes.find("\"asset\"") != std::string_view::npos;
}

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
        refuse(path, name + " has no bytes, neither in this file nor in another");
      }
      content = container.binary;
    } else if (is_data(uri)) {
      content = embedded(path, uri);
    } else {
      const std::string place = companion(path, uri, outside_buffers);
      std::error_code unknown;
      const auto size = std::filesystem::file_size(place, unknown);
      if (!unknown && size > left) refuse(path, "its buffers have more than 4 GiB");
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
      refuse(path, name + " is cut short: of " + std::to_string(stated) + " bytes " +
                       std::to_string(content.size()) + " are there");
    }
    content.resize(static_cast<std::size_t>(stated));
    file.buffers.push_back(std::move(content));
  }
  return file;
}

std::vector<std::string> gltf_companions(const std::string& path, std::string_view bytes,
                                         bool outside_buffers) {
  std::vector<std::string> files;
  for (const std::string& uri : references(path, parsed(path, opened(path, bytes).json))) {
    if (!uri.empty() && !is_data(uri)) files.push_back(companion(path, uri, outside_buffers));
  }
  return files;
}

}  // namespace spm::baker
