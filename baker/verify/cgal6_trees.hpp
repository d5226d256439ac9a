// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/AABB_traits_3.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive_3.h>

namespace spm::baker {

template <class Kernel, class Iterator>
using TrianglePrimitive = CGAL::AABB_triangle_primitive_3<Kernel, Iterator>;
template <class Kernel, class Primitive>
using CgalTree = CGAL::AABB_tree<CGAL::AABB_traits_3<Kernel, Primitive>>;

}  // namespace spm::baker
