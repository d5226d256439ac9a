// SPDX-License-Identifier: Apache-2.0
// The nearest triangle of a list, by several at once in single precision.
#include "common/field/nearest_triangle.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/base/random.hpp"
#include "common/surface/closest_on_triangle.hpp"

namespace spm::nearest_triangle_test {
namespace {

constexpr double step = 4e-7;          // m, as of a bake
constexpr double reach = 1e-2;         // m
constexpr double single_error = 0.05;  // steps: far below the one that bakes allow
constexpr double few_steps = 16;       // nearer than that queries use doubles
constexpr double turn = 1e-3;          // rad

/// Triangles by seed of some hundred to some thousand steps, and a list that names them all.
class Soup {
 public:
  Soup(std::size_t triangles, bool wide, bool thin, std::uint64_t seed) : seed_(seed) {
    for (std::uint32_t t = 0; t < triangles; ++t) add_triangle(t, thin && t % 3 == 0);
    sides_.resize((triangles + 1) / 2, 0);
    mesh = {.step = step, .corners = corners_, .triangles = triangles_, .sides = sides_};
    list_words_.push_back(0);
    for (std::uint32_t t = 0; t < triangles; ++t) {
      if (wide || t % 2 == 0) {
        list_words_.push_back(t);
      } else {
        list_words_.back() |= t << 16U;
      }
    }
    // Bounds of 0: no packet is passed over.
    list_words_.resize(list_words_.size() + packets_of(triangles), 0);
    list = {
        .solids = static_cast<std::uint32_t>(triangles), .wide = wide, .words = list_words_.data()};
  }
  Soup(const Soup&) = delete;
  Soup& operator=(const Soup&) = delete;

  IndexedTriangles mesh;
  TriangleList list;

  /// In the middle of them, or some thousand steps away.
  [[nodiscard]] Vector3 place(std::uint64_t k) const {
    return step * (Vector3::Constant(6000) + 12000 * random_vector(1'000'000 + k));
  }

 private:
  std::uint64_t seed_;
  std::vector<std::uint32_t> corners_, triangles_, sides_, list_words_;

  [[nodiscard]] Vector3 random_vector(std::uint64_t k) const {
    return {random_unit(seed_, 3 * k) - 0.5, random_unit(seed_, 3 * k + 1) - 0.5,
            random_unit(seed_, 3 * k + 2) - 0.5};
  }

  static void add_word(std::vector<std::uint32_t>& words, std::uint64_t word) {
    words.push_back(static_cast<std::uint32_t>(word));
    words.push_back(static_cast<std::uint32_t>(word >> 32U));
  }

  void add_triangle(std::uint32_t t, bool thin) {
    const Vector3 first = Vector3::Constant(6000) + 4000 * random_vector(4 * std::uint64_t{t});
    std::array<std::uint32_t, 3> numbers{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vector3 corner = first + 1500 * random_vector(4 * std::uint64_t{t} + 1 + k);
      add_word(corners_, pack_three({static_cast<std::uint32_t>(corner[0]),
                                     static_cast<std::uint32_t>(corner[1]),
                                     static_cast<std::uint32_t>(corner[2])}));
      numbers[k] = 3 * t + k;
    }
    add_word(triangles_, pack_three(numbers, thin));
  }
};

ClosestFeature closest_of(const Soup& soup, std::uint32_t triangle, const Vector3& place) {
  const auto corners = corners_of(soup.mesh, triangle);
  return closest_feature(place, corners[0], corners[1], corners[2]);
}

double least_distance(const Soup& soup, const Vector3& place) {
  double least = 1;
  for (std::uint32_t t = 0; t < soup.list.solids; ++t) {
    least = std::min(least, (place - closest_of(soup, t, place).point).norm());
  }
  return least;
}

struct Differences {
  double distance = 0, own_distance = 0;  ///< the largest, steps
  double away = 0;                        ///< the largest, as a share of the distance
  std::size_t places = 0, with_closest = 0, features = 0, signs = 0;
};

void compare(const Soup& soup, std::uint64_t places, Differences& found) {
  for (std::uint64_t k = 0; k < places; ++k) {
    const Vector3 place = soup.place(k);
    const NearestTriangle nearest =
        nearest_triangle(soup.mesh, soup.list, ListPart::solids, reach, place);
    const ClosestFeature truth = closest_of(soup, nearest.triangle, place);
    const Vector3 away = (place - truth.point) / step;
    const double least = least_distance(soup, place) / step;
    ++found.places;
    found.distance =
        std::max(found.distance, std::abs(std::sqrt(static_cast<double>(nearest.square)) - least));
    found.own_distance = std::max(found.own_distance, away.norm() - least);
    if (!nearest.has_closest) continue;
    ++found.with_closest;
    const Vector3 told(static_cast<double>(nearest.away[0]), static_cast<double>(nearest.away[1]),
                       static_cast<double>(nearest.away[2]));
    if (away.norm() > few_steps) {
      found.away = std::max(found.away, (told - away).norm() / away.norm());
    }
    found.features += nearest.feature != truth.feature ? 1U : 0U;
    const double along = truth.normal.normalized().dot(away);
    // Of ways too slanted to tell a side it is 0.
    found.signs +=
        std::abs(along) > 1 && nearest.along != 0 && (along < 0) != (nearest.along < 0) ? 1U : 0U;
  }
}

/// Of lists of 1 to 30 triangles, narrow and wide in turn. None is farther off than is allowed.
Differences compare_many(bool thin) {
  Differences found;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Soup soup(1 + seed % 30, seed % 2 == 1, thin, seed);
    compare(soup, 400, found);
  }
  CHECK(found.distance < single_error);
  CHECK(found.own_distance < single_error);
  CHECK(found.away < turn);
  return found;
}

}  // namespace

TEST_CASE("The nearest triangle of a list and its closest point are those of double precision") {
  const Differences found = compare_many(false);
  CHECK(found.with_closest == found.places);
  CHECK(found.signs == 0);
  // Where the closest point is all but at the end of a side, it may count as either.
  CHECK(found.features * 1000 < found.places);
}

TEST_CASE("Triangles that are marked as thin are measured in doubles, beside others that are not") {
  const Differences found = compare_many(true);
  CHECK(found.with_closest < found.places);
}

TEST_CASE("Sheets are passed over by their own bounds, not by those of solids") {
  constexpr std::size_t solids = 16, sheets = 24;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Soup soup(solids + sheets, true, false, seed);
    // Both packets of solids as far as can be, the three of sheets as near.
    std::vector<std::uint32_t> words(soup.list.words, soup.list.words + soup.list.number_words());
    words.insert(words.end(), {0x0000FFFFU, 0});
    TriangleList list = soup.list;
    list.solids = solids;
    list.sheets = sheets;
    list.words = words.data();
    REQUIRE(list.has_bounds());
    for (std::uint64_t k = 0; k < 50; ++k) {
      const Vector3 place = soup.place(k);
      double least = 1;
      for (std::uint32_t t = solids; t < solids + sheets; ++t) {
        least = std::min(least, (place - closest_of(soup, t, place).point).norm());
      }
      const NearestTriangle found =
          nearest_triangle(soup.mesh, list, ListPart::sheets, reach, place);
      REQUIRE(std::sqrt(static_cast<double>(found.square)) ==
              Approx(least / step).margin(single_error));
    }
  }
}

TEST_CASE("A list of no triangles has no nearest one") {
  const Soup soup(3, false, false, 1);
  TriangleList none = soup.list;
  none.solids = 0;
  CHECK_FALSE(std::isfinite(
      nearest_triangle(soup.mesh, none, ListPart::solids, reach, soup.place(0)).square));
}

}  // namespace spm::nearest_triangle_test
