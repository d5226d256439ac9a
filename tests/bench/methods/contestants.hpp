// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "tests/bench/base/timing.hpp"
#include "tests/bench/methods/mesh_proxy.hpp"
#include "tests/bench/methods/method.hpp"
#include "tests/bench/methods/probe_method.hpp"

namespace spm::bench {

// The timed object for each kind of method. The method that it refers to must outlive it.

/// A method, queried at all points of a block at once.
[[nodiscard]] std::unique_ptr<Contestant> contestant_of(const Method& method);

/// A ball at each point.
[[nodiscard]] std::unique_ptr<Contestant> contestant_of(ProbeMethod& method);

/// A proxy that follows the path. At a fresh place it is first put on the free side.
[[nodiscard]] std::unique_ptr<Contestant> contestant_of(MeshProxy& proxy);

}  // namespace spm::bench
