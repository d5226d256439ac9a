// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "baker/mesh/gltf_file.hpp"

namespace spm::baker {

/// Values of a buffer: `count` times `width` numbers of a component type, as glTF numbers them.
struct GltfValues {
  const char* first = nullptr;
  std::size_t count = 0, width = 0, stride = 0;
  int type = 0;
  bool normalized = false;
  std::shared_ptr<const std::string> own;  ///< what `first` points into, where no buffer has it

  [[nodiscard]] double at(std::size_t row, std::size_t column) const;
};

/// Lists, numbers and accessors of a glTF. All throw BakeError invalid_input, which names the
/// place.
class GltfAccessors {
 public:
  using Json = nlohmann::json;

  GltfAccessors(const std::string& path, std::string_view bytes, bool outside_buffers)
      : path_(path), file_(open_gltf(path, bytes, outside_buffers)) {}

  [[noreturn]] void refuse(const std::string& cause,
                           const std::string& cure = "export the mesh again") const;

  [[nodiscard]] const Json& list(const char* name) const;
  [[nodiscard]] const Json& item(const char* name, std::size_t index) const;

  /// What an extension says of an object; nothing where it is not there.
  [[nodiscard]] const Json* extension(const Json& object, const char* name) const;

  /// A whole number of an object; `otherwise` where it is not there.
  [[nodiscard]] std::uint64_t number(const Json& object, const char* key,
                                     std::optional<std::uint64_t> otherwise,
                                     const std::string& where) const;

  /// Numbers of an object, so many; nothing where they are not there.
  [[nodiscard]] std::optional<std::vector<double>> numbers(const Json& object, const char* key,
                                                           std::size_t count,
                                                           const std::string& where) const;

  /// The numbers that an accessor names, all of which are there. `counted`: their count alone,
  /// where they would have to be made first.
  [[nodiscard]] GltfValues values_of(std::size_t index, std::size_t width, const std::string& where,
                                     bool counted);

  /// The bytes of a view, unpacked.
  [[nodiscard]] std::string_view view_bytes(std::size_t index, const std::string& place);

 private:
  const std::string& path_;

 protected:
  GltfFile file_;

 private:
  [[nodiscard]] std::string_view range(const Json& view, const std::string& place) const;
  [[nodiscard]] std::string unpacked(const Json& packed, const std::string& place);
  void find_values(const Json& object, const std::string& place, GltfValues& values);
  void add_sparse(const Json& sparse, const std::string& place, GltfValues& values);

  std::map<std::size_t, std::string> unpacked_;  ///< by the view
  std::uint64_t unpacked_bytes_ = 0;
};

}  // namespace spm::baker
