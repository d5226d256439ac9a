// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "tests/bench/base/timing.hpp"
#include "tests/bench/methods/mesh_proxy.hpp"
#include "tests/bench/methods/method.hpp"
#include "tests/bench/methods/probe_method.hpp"

namespace spm::bench {

// What is timed, for each kind of method; each refers to a method that must outlive it.

/// A method without memory: asked at the points of a block at once.
[[nodiscard]] std::unique_ptr<Contestant> contestant_of(const Method& method);

/// A ball at each point.
[[nodiscard]] std::unique_ptr<Contestant> contestant_of(ProbeMethod& method);

/// A proxy that follows; where a place is fresh it is put on the free side first.
[[nodiscard]] std::unique_ptr<Contestant> contestant_of(MeshProxy& proxy);

}  // namespace spm::bench
