// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/trees/sign_octree_build.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "baker/proof/tile_bins.hpp"
#include "common/base/octant.hpp"

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
SignKind side_of(const SignOctreeNode& node, const ClosestPoint& closest) {
  if (closest.clearance <= slack * half_diagonal * node.edge) return SignKind::boundary;
  return closest.distance < 0 ? SignKind::inside : SignKind::outside;
}

void divide(SignOctreeNode& node) {
  node.kind = SignKind::split;
  node.octants = std::make_unique<std::array<SignOctreeNode, 8>>();
  for (std::size_t k = 0; k < 8; ++k) {
    SignOctreeNode& octant = (*node.octants)[k];
    octant.edge = node.edge / 2;
    octant.middle = node.middle + node.edge / 4 * octant_direction(k);
  }
}

/// Undoes a division into eight octants of the same kind.
void join(SignOctreeNode& node) {
  const SignOctreeNode& first = node.octants->front();
  const bool alike =
      std::all_of(node.octants->begin(), node.octants->end(), [&](const SignOctreeNode& octant) {
        return octant.kind == first.kind && octant.rule == first.rule;
      });
  if (!alike || first.kind == SignKind::split) return;
  node.kind = first.kind;
  node.rule = first.rule;
  node.octants.reset();
}

void visit(const SignOctreeNode& node, const std::function<void(const SignOctreeNode&)>& visitor) {
  if (!node.octants) {
    visitor(node);
    return;
  }
  for (const SignOctreeNode& octant : *node.octants) visit(octant, visitor);
}

}  // namespace

SignOctreeBuilder::SignOctreeBuilder(const Caster& caster, const Band& band, double tolerance,
                                     const Reachability* reachability, const Progress& progress)
    : caster_(caster), band_(band), tolerance_(tolerance), reachability_(reachability) {
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
  visit(root_, [&cut](const SignOctreeNode& leaf) { cut = cut || leaf.kind == SignKind::pruned; });
  if (reachability_ != nullptr && !cut) {
    // Small cubes that leave nothing out only cost bytes.
    reachability_ = nullptr;
    root_.octants.reset();
    decide(root_, 0);
  }
  if (progress) progress("sign octree", 1);
}

void SignOctreeBuilder::decide(SignOctreeNode& node, int level) const {
  const ClosestPoint closest = caster_.closest(node.middle);
  const SignKind side = side_of(node, closest);
  const bool boundary = side == SignKind::boundary;
  const double radius = slack * half_diagonal * node.edge;
  if (!boundary && closest.distance - radius > band_.margin + 2 * tolerance_) {
    node.kind = SignKind::far;
    return;
  }
  const double finest = reachability_ != nullptr ? finest_cut_share : finest_share;
  if (node.edge > finest * caster_.diagonal() && (boundary || reachability_ != nullptr)) {
    divide(node);
    if (level < parallel_levels) {
      tbb::parallel_for(std::size_t{0}, std::size_t{8},
                        [&](std::size_t k) { decide((*node.octants)[k], level + 1); });
    } else {
      for (SignOctreeNode& octant : *node.octants) decide(octant, level + 1);
    }
    join(node);
    return;
  }
  node.kind = side;
  if (reachability_ != nullptr) node.rule = reachability_->cube(node.middle, node.edge);
  if (node.rule != PruneRule::none) node.kind = SignKind::pruned;
}

bool SignOctreeBuilder::resolve(const Vector3& point) {
  SignOctreeNode* node = &root_;
  bool divided = false;
  for (int level = 0; level < sign_octree_levels; ++level) {
    if (!node->octants) {
      if (node->kind != SignKind::boundary || level == sign_octree_levels - 1) return divided;
      divide(*node);
      divided = true;
      for (SignOctreeNode& octant : *node->octants) {
        octant.kind = side_of(octant, caster_.closest(octant.middle));
      }
    }
    node = &(*node->octants)[octant_of(node->middle, point)];
  }
  return divided;
}

SignKind SignOctreeBuilder::place(const Vector3& point) const {
  const SignOctreeNode* node = &root_;
  if ((point - root_.middle).cwiseAbs().maxCoeff() >= root_.edge / 2) return SignKind::far;
  while (node->octants) node = &(*node->octants)[octant_of(node->middle, point)];
  return node->kind;
}

void SignOctreeBuilder::visit_leaves(
    const std::function<void(const SignOctreeNode&)>& visitor) const {
  visit(root_, visitor);
}

SignOctreeData SignOctreeBuilder::data() const {
  SignOctreeData data;
  data.edge = root_.edge;
  data.origin = root_.middle - Vector3::Constant(root_.edge / 2);
  SignOctreeNode whole;  // a root that is a leaf still needs a node
  if (!root_.octants) {
    whole.middle = root_.middle;
    whole.edge = root_.edge;
    divide(whole);
    for (SignOctreeNode& octant : *whole.octants) octant.kind = root_.kind;
  }
  std::vector<const SignOctreeNode*> nodes{root_.octants ? &root_ : &whole};
  // Level by level, so that the divided octants of a node follow each other.
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::uint32_t kinds = 0;
    const auto first = static_cast<std::uint32_t>(nodes.size());
    for (std::size_t k = 0; k < 8; ++k) {
      const SignOctreeNode& octant = (*nodes[i]->octants)[k];
      kinds |= static_cast<std::uint32_t>(octant.kind) << (sign_kind_bits * k);
      if (octant.octants) nodes.push_back(&octant);
    }
    data.words.push_back(kinds);
    data.words.push_back(nodes.size() > first ? first : 0);
  }
  return data;
}

}  // namespace spm::baker
