// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "baker/base/bake_error.hpp"
#include "common/base/error.hpp"

namespace spm::bench {

/// The value of a result; throws BakeError if there is none.
template <class T>
[[nodiscard]] T unwrap(Result<T> result) {
  if (!result) throw baker::BakeError(result.error().code, result.error().message);
  return std::move(*result);
}

}  // namespace spm::bench
