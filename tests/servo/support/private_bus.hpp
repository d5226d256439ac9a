// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <string>

namespace spm::test {

/// A bus of the test's own, which programs take for the system's or the user's.
class PrivateBus {
 public:
  /// `variable`: of the environment, by which programs find the bus while this exists.
  explicit PrivateBus(const char* variable = "DBUS_SYSTEM_BUS_ADDRESS") : variable_(variable) {
    std::array<int, 2> told{};
    REQUIRE(pipe(told.data()) == 0);
    process_ = fork();
    if (process_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      dup2(told[1], STDOUT_FILENO);
      execlp("dbus-daemon", "dbus-daemon", "--session", "--nofork", "--nopidfile",
             "--print-address=1", nullptr);
      _exit(127);
    }
    close(told[1]);
    std::string address;
    for (char byte = 0; read(told[0], &byte, 1) == 1 && byte != '\n';) address += byte;
    close(told[0]);
    INFO("the test needs dbus-daemon");
    REQUIRE(!address.empty());
    setenv(variable_, address.c_str(), 1);
  }
  PrivateBus(const PrivateBus&) = delete;
  PrivateBus& operator=(const PrivateBus&) = delete;
  ~PrivateBus() {
    unsetenv(variable_);
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }

 private:
  const char* variable_;
  pid_t process_ = -1;
};

}  // namespace spm::test
