// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/gltf_compressed.hpp"

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <limits>

#include "baker/mesh/mesh_limits.hpp"

namespace spm::baker {
namespace {

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

}  // namespace

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

}  // namespace spm::baker
