// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <functional>
#include <string>

namespace spm::servo {

/// What takes a sentence for the user.
using TellUser = std::function<void(const std::string&)>;

/// How a coroutine of the view ends that may end alone, such as a connection's: an exception, which
/// a detached one would lose without a word, is told.
struct EndTold {
  TellUser tell;
  void operator()(const std::exception_ptr& problem) const;
};

/// How one ends without which there is no view: its exception ends the view.
struct EndsView {
  void operator()(const std::exception_ptr& problem) const {
    if (problem) std::rethrow_exception(problem);
  }
};

}  // namespace spm::servo
