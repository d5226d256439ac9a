// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trees/space_build.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "baker/base/octant.hpp"
#include "baker/proof/tile_bins.hpp"

namespace spm::baker {

namespace {

/// Cubes are not divided below this share of the diagonal, except for the side.
constexpr double finest_share = 1.0 / 25;
/// The same where the bake may leave some cubes out.
constexpr double finest_cut_share = 1.0 / 100;
constexpr int parallel_levels = 2;
const double half_diagonal = std::sqrt(3.0) / 2;
/// Room for the rounding of distances.
constexpr double slack = 1 + 1e-9;

/// The kind of a cube, from the surface or cap that is closest to its middle.
SpaceKind side_of(const SpaceNode& node, const ClosestPoint& closest) {
  if (closest.clear <= slack * half_diagonal * node.edge) return SpaceKind::told;
  return closest.distance < 0 ? SpaceKind::inside : SpaceKind::outside;
}

void divide(SpaceNode& node) {
  node.kind = SpaceKind::split;
  node.octants = std::make_unique<std::array<SpaceNode, 8>>();
  for (std::size_t k = 0; k < 8; ++k) {
    SpaceNode& octant = (*node.octants)[k];
    octant.edge = node.edge / 2;
    octant.middle = node.middle + node.edge / 4 * octant_direction(k);
  }
}

std::size_t octant_of(const SpaceNode& node, const Vector3& point) {
  std::size_t octant = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const int k = static_cast<int>(axis);
    if (point[k] >= node.middle[k]) octant |= std::size_t{1} << axis;
  }
  return octant;
}

/// Undoes a division into eight octants of the same kind.
void join(SpaceNode& node) {
  const SpaceNode& first = node.octants->front();
  const bool alike =
      std::all_of(node.octants->begin(), node.octants->end(), [&](const SpaceNode& octant) {
        return octant.kind == first.kind && octant.rule == first.rule;
      });
  if (!alike || first.kind == SpaceKind::split) return;
  node.kind = first.kind;
  node.rule = first.rule;
  node.octants.reset();
}

void visit(const SpaceNode& node, const std::function<void(const SpaceNode&)>& visitor) {
  if (!node.octants) {
    visitor(node);
    return;
  }
  for (const SpaceNode& octant : *node.octants) visit(octant, visitor);
}

}  // namespace

SpaceBuilder::SpaceBuilder(const Caster& caster, const Band& band, double tolerance,
                           const Reach* reach, const Progress& progress)
    : caster_(caster), band_(band), tolerance_(tolerance), reach_(reach) {
  Box box;
  for (std::uint32_t i = 0; i < caster.surface_count(); ++i) {
    for (int k = 0; k < 3; ++k) box.include(caster.corner(i, k));
  }
  // A little more than the band, so that no border of a cube lies at its end.
  const double margin = 1.01 * (band.margin + 2 * tolerance);
  root_.edge = (box.high - box.low).maxCoeff() + 2 * margin;
  root_.middle = (box.low + box.high) / 2;
  decide(root_, 0);
  bool cut = false;
  visit(root_, [&cut](const SpaceNode& leaf) { cut = cut || leaf.kind == SpaceKind::pruned; });
  if (reach_ != nullptr && !cut) {
    // Small cubes that leave nothing out only cost bytes.
    reach_ = nullptr;
    root_.octants.reset();
    decide(root_, 0);
  }
  if (progress) progress("space", 1);
}

void SpaceBuilder::decide(SpaceNode& node, int level) const {
  const ClosestPoint closest = caster_.closest(node.middle);
  const SpaceKind side = side_of(node, closest);
  const bool told = side == SpaceKind::told;
  const double radius = slack * half_diagonal * node.edge;
  if (!told && closest.distance - radius > band_.margin + 2 * tolerance_) {
    node.kind = SpaceKind::far;
    return;
  }
  const double finest = reach_ != nullptr ? finest_cut_share : finest_share;
  if (node.edge > finest * caster_.diagonal() && (told || reach_ != nullptr)) {
    divide(node);
    if (level < parallel_levels) {
      tbb::parallel_for(std::size_t{0}, std::size_t{8},
                        [&](std::size_t k) { decide((*node.octants)[k], level + 1); });
    } else {
      for (SpaceNode& octant : *node.octants) decide(octant, level + 1);
    }
    join(node);
    return;
  }
  node.kind = side;
  if (reach_ != nullptr) node.rule = reach_->cube(node.middle, node.edge);
  if (node.rule != PruneRule::none) node.kind = SpaceKind::pruned;
}

bool SpaceBuilder::mend(const Vector3& point) {
  SpaceNode* node = &root_;
  bool divided = false;
  for (int level = 0; level < space_levels; ++level) {
    if (!node->octants) {
      if (node->kind != SpaceKind::told || level == space_levels - 1) return divided;
      divide(*node);
      divided = true;
      for (SpaceNode& octant : *node->octants) {
        octant.kind = side_of(octant, caster_.closest(octant.middle));
      }
    }
    node = &(*node->octants)[octant_of(*node, point)];
  }
  return divided;
}

SpaceKind SpaceBuilder::place(const Vector3& point) const {
  const SpaceNode* node = &root_;
  if ((point - root_.middle).cwiseAbs().maxCoeff() >= root_.edge / 2) return SpaceKind::far;
  while (node->octants) node = &(*node->octants)[octant_of(*node, point)];
  return node->kind;
}

void SpaceBuilder::visit_leaves(const std::function<void(const SpaceNode&)>& visitor) const {
  visit(root_, visitor);
}

SpaceData SpaceBuilder::data() const {
  SpaceData data;
  data.edge = root_.edge;
  data.origin = root_.middle - Vector3::Constant(root_.edge / 2);
  SpaceNode whole;  // a root that is a leaf still needs a node
  if (!root_.octants) {
    whole.middle = root_.middle;
    whole.edge = root_.edge;
    divide(whole);
    for (SpaceNode& octant : *whole.octants) octant.kind = root_.kind;
  }
  std::vector<const SpaceNode*> nodes{root_.octants ? &root_ : &whole};
  // Level by level, so that the divided octants of a node follow each other.
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::uint32_t kinds = 0;
    const auto first = static_cast<std::uint32_t>(nodes.size());
    for (std::size_t k = 0; k < 8; ++k) {
      const SpaceNode& octant = (*nodes[i]->octants)[k];
      kinds |= static_cast<std::uint32_t>(octant.kind) << (space_kind_bits * k);
      if (octant.octants) nodes.push_back(&octant);
    }
    data.words.push_back(kinds);
    data.words.push_back(nodes.size() > first ? first : 0);
  }
  return data;
}

}  // namespace spm::baker
