// SPDX-License-Identifier: GPL-3.0-or-later
// Asks judges that this project did not write on which side of a mesh's solid places lie, each
// where its own rules apply, and compares what an asset answers there. Prints a JSON object; exit 0
// whatever they say. Usage: spm-judges ASSET MESH PLACES SEED FILE, with a mesh that CGAL reads:
// OBJ, OFF, PLY or STL. FILE gets the triangles and the places with their answers, for judges in
// other languages.
#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "common/query/query.hpp"
#include "common/surface/closest_on_triangle.hpp"
#include "formats/asset/mapped_asset.hpp"

namespace spm::judges {
namespace {

using Json = nlohmann::ordered_json;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;
namespace pmp = CGAL::Polygon_mesh_processing;

/// Most disagreements that are listed of a judge.
constexpr std::size_t most_listed = 20;
/// Voxels along the diagonal, and how far the wrap lies outside, as a share of it.
constexpr double voxels = 300, wrap_share = 1.0 / 300;

/// A file's faces as CGAL reads them, fanned, in the asset's frame, m.
struct Soup {
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> triangles;
};

std::optional<Soup> read(const std::string& path, double factor) {
  Soup soup;
  std::vector<std::vector<std::size_t>> faces;
  if (!CGAL::IO::read_polygon_soup(path, soup.points, faces)) return std::nullopt;
  for (Point& point : soup.points) {
    point = {factor * point.x(), factor * point.y(), factor * point.z()};
  }
  for (const auto& face : faces) {
    for (std::size_t k = 1; k + 1 < face.size(); ++k) {
      soup.triangles.push_back({face[0], face[k], face[k + 1]});
    }
  }
  return soup;
}

Vector3 vector(const Point& point) { return {point.x(), point.y(), point.z()}; }
Point point(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

/// What a judge says of a place: inside, outside, or nothing.
using Judge = std::function<std::optional<bool>(const Vector3&)>;

/// A judge, how far from the surface it is to be believed, and why it is not asked.
struct Named {
  std::string name;
  std::string not_asked;
  double blur = 0;
  Judge judge;
};

/// CGAL's side of a closed mesh, after its own repair of the soup.
Named side_judge(const Soup& soup) {
  Named named{"CGAL Side_of_triangle_mesh", {}, 0, {}};
  Soup repaired = soup;
  pmp::repair_polygon_soup(repaired.points, repaired.triangles);
  if (!pmp::orient_polygon_soup(repaired.points, repaired.triangles)) {
    named.not_asked = "its repair had to cut the surface open to orient it";
    return named;
  }
  auto surface = std::make_shared<Surface>();
  pmp::polygon_soup_to_polygon_mesh(repaired.points, repaired.triangles, *surface);
  pmp::stitch_borders(*surface);
  if (!CGAL::is_closed(*surface)) {
    named.not_asked = "the surface is open after its repair";
    return named;
  }
  if (pmp::does_self_intersect(*surface)) {
    named.not_asked = "the surface crosses itself";
    return named;
  }
  pmp::orient_to_bound_a_volume(*surface);
  auto side = std::make_shared<CGAL::Side_of_triangle_mesh<Surface, Kernel>>(*surface);
  named.judge = [surface, side](const Vector3& place) -> std::optional<bool> {
    const CGAL::Bounded_side found = (*side)(point(place));
    if (found == CGAL::ON_BOUNDARY) return std::nullopt;
    return found == CGAL::ON_BOUNDED_SIDE;
  };
  return named;
}

/// CGAL's alpha wrap, which encloses all of the mesh: outside of it nothing is inside.
Named wrap_judge(const Soup& soup, double diagonal) {
  auto wrap = std::make_shared<Surface>();
  const double offset = wrap_share * diagonal;
  CGAL::alpha_wrap_3(soup.points, soup.triangles, 3 * offset, offset, *wrap);
  auto side = std::make_shared<CGAL::Side_of_triangle_mesh<Surface, Kernel>>(*wrap);
  return {"CGAL alpha_wrap_3, from outside",
          {},
          0,
          [wrap, side](const Vector3& place) -> std::optional<bool> {
            if ((*side)(point(place)) != CGAL::ON_UNBOUNDED_SIDE) return std::nullopt;
            return false;
          }};
}

/// OpenVDB's sign, which it finds by flooding voxels from outside.
Named vdb_judge(const Soup& soup, double diagonal) {
  openvdb::initialize();
  const double voxel = diagonal / voxels;
  std::vector<openvdb::Vec3s> points;
  for (const Point& p : soup.points) {
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()),
                        static_cast<float>(p.z()));
  }
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : soup.triangles) {
    triangles.emplace_back(static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                           static_cast<std::uint32_t>(t[2]));
  }
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  const auto grid = openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(
      *transform, points, triangles, {}, 4, 4);
  return {"OpenVDB meshToSignedDistanceField",
          {},
          2 * voxel,
          [grid](const Vector3& place) -> std::optional<bool> {
            const openvdb::Vec3d at(place.x(), place.y(), place.z());
            return openvdb::tools::BoxSampler::sample(grid->tree(), grid->worldToIndex(at)) < 0;
          }};
}

/// A place up to the band's depth beside a triangle, by number.
Vector3 place_beside(const Soup& soup, const Band& band, std::uint64_t seed, std::uint64_t k) {
  const auto random = [&](std::uint64_t i) { return random_unit(seed, 8 * k + i); };
  const auto& t = soup.triangles[static_cast<std::size_t>(
      random(0) * static_cast<double>(soup.triangles.size()))];
  const double root = std::sqrt(random(1)), share = random(2);
  const Vector3 a = vector(soup.points[t[0]]), b = vector(soup.points[t[1]]),
                c = vector(soup.points[t[2]]);
  const Vector3 on = (1 - root) * a + root * (1 - share) * b + root * share * c;
  return on + band.max_depth * random(3) * direction_of(random(4), random(5));
}

double unsigned_distance(const Soup& soup, const Vector3& place) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& t : soup.triangles) {
    const Vector3 closest = closest_on_triangle(
        place, vector(soup.points[t[0]]), vector(soup.points[t[1]]), vector(soup.points[t[2]]));
    least = std::min(least, (place - closest).norm());
  }
  return least;
}

/// A place, what the asset answers there, and how far the soup's nearest triangle is, m.
struct Place {
  Vector3 at = Vector3::Zero();
  bool inside = false;
  double answer = 0, away = 0;
};

/// Places that are farther from all triangles than the asset may err. Beside sheets, which have no
/// inside, it is below 0 within their half-thickness.
std::vector<Place> answered_places(const MappedAsset& asset, const Soup& soup, std::uint64_t count,
                                   std::uint64_t seed) {
  const AssetMetadata& metadata = asset.metadata();
  const double least = std::max(metadata.tolerance.value_or(0), metadata.sheet_thickness);
  std::vector<Place> places;
  for (std::uint64_t k = 0; k < count; ++k) {
    Place place;
    place.at = place_beside(soup, metadata.band, seed, k);
    place.away = unsigned_distance(soup, place.at);
    if (place.away <= 1.01 * least) continue;
    const Answer answer = query_point(asset.view(), place.at);
    place.answer = answer.distance;
    place.inside =
        answer.status == Status::deep || (answer.status == Status::exact && answer.distance < 0);
    places.push_back(place);
  }
  return places;
}

/// Where a judge and the asset disagree.
Json asked(const Named& named, const std::vector<Place>& places) {
  if (!named.judge) return {{"judge", named.name}, {"not_asked", named.not_asked}};
  std::uint64_t judged = 0, apart = 0;
  Json listed = Json::array();
  for (const Place& place : places) {
    if (place.away <= named.blur) continue;
    const std::optional<bool> inside = named.judge(place.at);
    if (!inside) continue;
    ++judged;
    if (place.inside == *inside || ++apart > most_listed) continue;
    listed.push_back({{"place_m", {place.at.x(), place.at.y(), place.at.z()}},
                      {"judge_inside", *inside},
                      {"answer_m", place.answer},
                      {"surface_m", place.away}});
  }
  return {{"judge", named.name}, {"judged", judged}, {"disagree", apart}, {"places", listed}};
}

/// For judges in other languages.
void write_places(const Soup& soup, const std::vector<Place>& places, const std::string& path) {
  Json json = {
      {"vertices", Json::array()}, {"triangles", soup.triangles}, {"places", Json::array()}};
  for (const Point& p : soup.points) json["vertices"].push_back({p.x(), p.y(), p.z()});
  for (const Place& place : places) {
    json["places"].push_back({{"place_m", {place.at.x(), place.at.y(), place.at.z()}},
                              {"inside", place.inside},
                              {"answer_m", place.answer},
                              {"surface_m", place.away}});
  }
  std::ofstream(path) << json.dump() << '\n';
}

int run(const std::string& asset_path, const std::string& mesh_path, std::uint64_t count,
        std::uint64_t seed, const std::string& places_path) {
  const auto asset = MappedAsset::open(asset_path);
  if (!asset) {
    std::cerr << asset.error().message << '\n';
    return static_cast<int>(asset.error().code);
  }
  const AssetMetadata& metadata = (*asset)->metadata();
  const auto soup = read(mesh_path, metadata.mesh_unit * metadata.scale);
  if (!soup || soup->triangles.empty()) {
    std::cerr << mesh_path << ": CGAL cannot read it\n";
    return static_cast<int>(ExitCode::invalid_input);
  }
  const std::vector<Place> places = answered_places(**asset, *soup, count, seed);
  write_places(*soup, places, places_path);
  Json report = {{"mesh", mesh_path}, {"places", places.size()}, {"judges", Json::array()}};
  for (const Named& named : {side_judge(*soup), wrap_judge(*soup, metadata.diagonal),
                             vdb_judge(*soup, metadata.diagonal)}) {
    report["judges"].push_back(asked(named, places));
  }
  std::cout << report.dump() << '\n';
  return 0;
}

}  // namespace
}  // namespace spm::judges

int main(int count, char** arguments) {
  if (count != 6) {
    std::cerr << "Usage: spm-judges ASSET MESH PLACES SEED FILE\n";
    return 1;
  }
  return spm::judges::run(arguments[1], arguments[2], std::strtoull(arguments[3], nullptr, 10),
                          std::strtoull(arguments[4], nullptr, 10), arguments[5]);
}
