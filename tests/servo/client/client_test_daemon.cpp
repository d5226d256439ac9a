// SPDX-License-Identifier: Apache-2.0
// The server at a socket, with a thread in the place of the loop, for tests of what applications
// use: the Python package and the examples. Ends with its standard input.
#include <cstdio>

#include "servo/app/app_server.hpp"
#include "tests/servo/support/loop_stand_in.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s SOCKET\n", argv[0]);
    return 1;
  }
  const auto state = spm::test::small_state();
  spm::test::LoopStandIn loop(*state);
  spm::servo::AppServerOptions options;
  options.path = argv[1];
  const auto server = spm::servo::AppServer::start(options, *state);
  if (!server) {
    std::fprintf(stderr, "error: %s\n", server.error().message.c_str());
    return static_cast<int>(server.error().code);
  }
  std::puts("ready");
  std::fflush(stdout);
  // A line each: what the device does from now on.
  for (int c = std::getchar(); c != EOF; c = std::getchar()) {
    if (c == 'c') loop.set_contact(true);
    if (c == 'f') loop.set_contact(false);
    if (c == 'b') loop.set_buttons(1);
    if (c == 'g') loop.set_cause(spm::servo::ForceOff::device_gone);
    if (c == 'n') loop.set_cause(spm::servo::ForceOff::none);
  }
  return 0;
}
