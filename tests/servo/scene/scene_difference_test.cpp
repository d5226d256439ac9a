// SPDX-License-Identifier: Apache-2.0
#include "servo/scene/scene_difference.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <random>

#include "servo/scene/scene_edit.hpp"

namespace scene_difference_test {

using namespace spm;
using namespace spm::servo;

namespace {

using Random = std::mt19937_64;

std::size_t below(Random& random, std::size_t bound) { return random() % bound; }
double drawn(Random& random) { return std::uniform_real_distribution<double>(0.1, 1)(random); }

/// A way in which an object can be edited, and its name in messages to the user.
struct Edit {
  ObjectAspect aspect;
  const char* name;
  std::function<void(PlacedObject&, Random&)> apply;
};

const std::vector<Edit> edits{
    {aspect_pose, "pose", [](auto& o, auto& r) { o.placement.position.y() = drawn(r); }},
    {aspect_pose, "pose",
     [](auto& o, auto& r) {
       o.placement.rotation = Eigen::AngleAxisd(drawn(r), Vector3::UnitZ());
     }},
    {aspect_scale, "scale", [](auto& o, auto& r) { o.placement.scale = drawn(r); }},
    {aspect_method, "method",
     [](auto& o, auto&) {
       o.force.method = o.force.method == Method::spm ? Method::proxy : Method::spm;
     }},
    {aspect_method, "method",
     [](auto& o, auto&) {
       o.force.rule =
           o.force.rule == PaperRule::all_planes ? PaperRule::closest_plane : PaperRule::all_planes;
     }},
    {aspect_stiffness, "stiffness", [](auto& o, auto& r) { o.force.stiffness = 1e3 * drawn(r); }},
    {aspect_stiffness, "stiffness", [](auto& o, auto& r) { o.force.density = drawn(r); }},
    {aspect_probe, "probe", [](auto& o, auto& r) { o.force.probe_radius = drawn(r); }},
    {aspect_probe, "probe", [](auto& o, auto& r) { o.force.probe_length = drawn(r); }},
    {aspect_probe, "probe", [](auto& o, auto&) { o.force.probe_axis = -o.force.probe_axis; }},
    {aspect_probe, "probe",
     [](auto& o, auto&) {
       o.force.probe_kind =
           o.force.probe_kind == ProbeKind::ball ? ProbeKind::capsule : ProbeKind::ball;
     }},
    {aspect_probe, "probe",
     [](auto& o, auto&) {
       o.force.form = o.force.form == PaperProbeForm::volume ? PaperProbeForm::surface
                                                             : PaperProbeForm::volume;
     }},
    {aspect_friction, "friction", [](auto& o, auto& r) { o.effects.friction.stick = drawn(r); }},
    {aspect_friction, "friction", [](auto& o, auto& r) { o.effects.friction.slide = drawn(r); }},
    {aspect_friction, "friction",
     [](auto& o, auto& r) { o.effects.friction.stiffness = drawn(r); }},
    {aspect_friction, "friction", [](auto& o, auto& r) { o.effects.friction_force = drawn(r); }},
    {aspect_friction, "friction", [](auto& o, auto& r) { o.effects.friction_depth = drawn(r); }},
    {aspect_damping, "damping", [](auto& o, auto& r) { o.effects.damping = drawn(r); }},
    {aspect_texture, "texture", [](auto& o, auto& r) { o.effects.texture.amplitude = drawn(r); }},
    {aspect_texture, "texture", [](auto& o, auto& r) { o.effects.texture.wavelength = drawn(r); }},
    {aspect_texture, "texture", [](auto& o, auto&) { ++o.effects.texture.seed; }},
    {aspect_texture, "texture", [](auto& o, auto& r) { o.effects.texture_noise = drawn(r); }},
    {aspect_texture, "texture", [](auto& o, auto&) { ++o.effects.noise_seed; }},
    {aspect_smoothing, "smoothing", [](auto& o, auto& r) { o.effects.smoothing.sigma = drawn(r); }},
    {aspect_smoothing, "smoothing", [](auto& o, auto&) { ++o.effects.smoothing.samples; }},
    {aspect_turn_limit, "turn_limit", [](auto& o, auto& r) { o.effects.turn.rate = drawn(r); }},
    {aspect_movable, "movable", [](auto& o, auto&) { o.movable = !o.movable; }},
};

PlacedObject object_of(std::size_t asset) {
  PlacedObject object;
  object.asset = asset;
  return object;
}

using Objects = std::vector<PlacedObject>;

Objects drawn_scene(Random& random) {
  Objects scene;
  for (std::size_t count = below(random, 7); count > 0; --count) {
    scene.push_back(object_of(below(random, 3)));
    for (std::size_t edit = below(random, 4); edit > 0; --edit) {
      edits[below(random, edits.size())].apply(scene.back(), random);
    }
  }
  return scene;
}

/// A scene as it may look after somebody has edited `scene`.
Objects edited_scene(Objects scene, Random& random) {
  for (std::size_t step = below(random, 5); step > 0; --step) {
    const auto place = static_cast<std::ptrdiff_t>(below(random, scene.size() + 1));
    const bool is_end = place == static_cast<std::ptrdiff_t>(scene.size());
    switch (below(random, 4)) {
      case 0:
        scene.insert(scene.begin() + place, object_of(below(random, 4)));
        break;
      case 1:
        if (!is_end) scene.erase(scene.begin() + place);
        break;
      case 2:
        if (!is_end) std::swap(scene.front(), scene[static_cast<std::size_t>(place)]);
        break;
      default:
        if (!is_end) edits[below(random, edits.size())].apply(*(scene.begin() + place), random);
    }
  }
  return scene;
}

/// Copies to one object those aspects of the other that a difference names, and nothing else.
PlacedObject with_aspects(PlacedObject object, const PlacedObject& from, std::uint32_t aspects) {
  const auto has = [aspects](ObjectAspect aspect) { return (aspects & aspect) != 0; };
  if (has(aspect_pose)) {
    object.placement.position = from.placement.position;
    object.placement.rotation = from.placement.rotation;
  }
  if (has(aspect_scale)) object.placement.scale = from.placement.scale;
  if (has(aspect_method)) {
    object.force.method = from.force.method;
    object.force.rule = from.force.rule;
  }
  if (has(aspect_stiffness)) {
    object.force.stiffness = from.force.stiffness;
    object.force.density = from.force.density;
  }
  if (has(aspect_probe)) {
    object.force.take_probe(from.force.probe());
    object.force.probe_axis = from.force.probe_axis;
    object.force.form = from.force.form;
  }
  EffectSettings& effects = object.effects;
  if (has(aspect_friction)) {
    effects.friction = from.effects.friction;
    effects.friction_force = from.effects.friction_force;
    effects.friction_depth = from.effects.friction_depth;
  }
  if (has(aspect_damping)) effects.damping = from.effects.damping;
  if (has(aspect_texture)) {
    effects.texture = from.effects.texture;
    effects.texture_noise = from.effects.texture_noise;
    effects.noise_seed = from.effects.noise_seed;
  }
  if (has(aspect_smoothing)) effects.smoothing = from.effects.smoothing;
  if (has(aspect_turn_limit)) effects.turn = from.effects.turn;
  if (has(aspect_movable)) object.movable = from.movable;
  return object;
}

/// Every number of an object in a row, so that the test compares by no function of its subject.
std::vector<double> numbers_of(const PlacedObject& o) {
  const EffectSettings& e = o.effects;
  return {static_cast<double>(o.asset),
          o.placement.position.x(),
          o.placement.position.y(),
          o.placement.position.z(),
          o.placement.rotation.w(),
          o.placement.rotation.x(),
          o.placement.rotation.y(),
          o.placement.rotation.z(),
          o.placement.scale,
          static_cast<double>(o.force.method),
          static_cast<double>(o.force.rule),
          o.force.stiffness,
          o.force.density,
          o.force.probe_radius,
          o.force.probe_length,
          o.force.probe_axis.z(),
          static_cast<double>(o.force.probe_kind),
          static_cast<double>(o.force.form),
          e.friction.stick,
          e.friction.slide,
          e.friction.stiffness,
          e.damping,
          e.texture.amplitude,
          e.texture.wavelength,
          static_cast<double>(e.texture.seed),
          e.smoothing.sigma,
          static_cast<double>(e.smoothing.samples),
          e.turn.rate,
          e.turn.jump,
          e.turn.step,
          e.friction_force,
          e.friction_depth,
          e.texture_noise,
          static_cast<double>(e.noise_seed),
          o.movable ? 1.0 : 0.0};
}

/// The edited scene, made from the old one and a difference. Whatever the difference does not name
/// in the new scene is not used.
std::vector<std::vector<double>> applied(const Objects& before, const Objects& after,
                                         const SceneDifference& difference) {
  std::vector<std::vector<double>> made(after.size());
  for (const KeptObject& kept : difference.kept) {
    REQUIRE(made.at(kept.after).empty());
    made[kept.after] =
        numbers_of(with_aspects(before.at(kept.before), after[kept.after], kept.aspects));
  }
  for (const std::size_t added : difference.added) {
    REQUIRE(made.at(added).empty());
    made[added] = numbers_of(after[added]);
  }
  return made;
}

}  // namespace

TEST_CASE("The difference of two scenes, applied to the one, gives the other") {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    CAPTURE(seed);
    Random random(seed);
    const Objects before = drawn_scene(random);
    const Objects after = seed % 2 == 0 ? edited_scene(before, random) : drawn_scene(random);
    const SceneDifference difference = scene_difference(before, after);

    std::vector<std::vector<double>> wanted;
    for (const PlacedObject& object : after) wanted.push_back(numbers_of(object));
    REQUIRE(applied(before, after, difference) == wanted);

    // Each old object is removed or kept, and no object counts as new if an old one could match it.
    std::vector<std::size_t> ends = difference.removed;
    for (const KeptObject& kept : difference.kept) {
      ends.push_back(kept.before);
      REQUIRE(before[kept.before].asset == after[kept.after].asset);
    }
    std::sort(ends.begin(), ends.end());
    REQUIRE(ends.size() == before.size());
    REQUIRE(std::adjacent_find(ends.begin(), ends.end()) == ends.end());
    for (const std::size_t removed : difference.removed) {
      for (const std::size_t added : difference.added) {
        REQUIRE(before[removed].asset != after[added].asset);
      }
    }
  }
}

TEST_CASE("Every number of an object is of one aspect, which has its key's name") {
  for (const Edit& edit : edits) {
    CAPTURE(edit.name);
    Random random(1);
    const PlacedObject before = object_of(0);
    PlacedObject after = before;
    edit.apply(after, random);
    REQUIRE(aspects_of(before, after) == edit.aspect);
    REQUIRE(names_of_aspects(edit.aspect) == edit.name);
    const SceneDifference difference = scene_difference(Objects{before}, Objects{after});
    REQUIRE_FALSE(difference.empty());
  }
  REQUIRE(names_of_aspects(aspect_pose | aspect_stiffness) == "pose, stiffness");
  REQUIRE(names_of_aspects(0).empty());
}

TEST_CASE("An object that is cut out of the middle is the one that is gone") {
  Objects before(3, object_of(0));
  for (std::size_t i = 0; i < 3; ++i)
    before[i].placement.position.x() = 0.1 * static_cast<double>(i + 1);
  Objects after = before;
  after.erase(after.begin() + 1);
  SceneDifference difference = scene_difference(before, after);
  CHECK(difference.removed == std::vector<std::size_t>{1});
  CHECK(difference.added.empty());
  REQUIRE(difference.kept.size() == 2);
  CHECK(difference.kept[1].before == 2);
  CHECK(difference.kept[1].aspects == 0);

  // If every object was changed, they are matched by their places in the list.
  after = before;
  for (PlacedObject& object : after) object.force.stiffness = 1;
  difference = scene_difference(before, after);
  for (const KeptObject& kept : difference.kept) CHECK(kept.before == kept.after);

  // A changed order alone is no difference.
  after = {before[2], before[0], before[1]};
  difference = scene_difference(before, after);
  CHECK(difference.empty());
  CHECK(difference.kept[0].before == 2);
}

TEST_CASE("Objects keep their ids, and a new one gets the lowest that nobody has or had") {
  const std::vector<std::uint64_t> ids{4, 0, 2};
  const Objects before{object_of(0), object_of(1), object_of(2)};
  Objects after{object_of(3), object_of(2), object_of(0), object_of(3)};
  after[2].force.stiffness = 7;
  after[1].placement.position.x() = 1;
  const SceneDifference difference = scene_difference(before, after);
  const auto edited = edited_ids(difference, ids, after.size());
  REQUIRE(edited == std::vector<std::uint64_t>{1, 2, 4, 3});

  const SceneEdit edit = scene_edit(difference, ids, after, edited);
  CHECK(edit.removed == std::vector<std::uint64_t>{0});
  REQUIRE(edit.changed.size() == 2);
  CHECK(edit.changed[0].id == 2);
  CHECK(edit.changed[0].moved);
  CHECK(edit.changed[1].id == 4);
  CHECK_FALSE(edit.changed[1].moved);
  CHECK(edit.changed[1].settings.force.stiffness == 7);
  REQUIRE(edit.added.size() == 2);
  CHECK(edit.added[0].id == 1);
  CHECK(edit.added[1].id == 3);
}

}  // namespace scene_difference_test
