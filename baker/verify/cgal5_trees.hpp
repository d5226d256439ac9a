// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>

namespace spm::baker {

template <class Kernel, class Iterator>
using TrianglePrimitive = CGAL::AABB_triangle_primitive<Kernel, Iterator>;
template <class Kernel, class Primitive>
using CgalTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

}  // namespace spm::baker
