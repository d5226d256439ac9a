// SPDX-License-Identifier: Apache-2.0
// What the hand of a daemon feels at its next tick: watch SOCKET.
#include <spm_client.h>

#include <cmath>
#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  spm_client_options options = {};
  options.size = sizeof options;
  options.path = argv[1];
  options.timeout_ms = 10000;
  spm_client* client = nullptr;
  char message[512];
  const int code = spm_client_connect(&options, &client, message, sizeof message);
  if (code != SPM_CLIENT_OK) {
    std::fprintf(stderr, "%s\n", message);
    return code;
  }
  spm_client_tick tick = {};
  tick.size = sizeof tick;
  spm_client_device hand = {};
  hand.size = sizeof hand;
  const bool read = spm_client_wait_tick(client, 0, 10.0, &tick) == SPM_CLIENT_OK &&
                    spm_client_read_device(client, 0, &hand) == SPM_CLIENT_OK;
  const double* const force = hand.force;
  if (read) {
    std::printf("%.3f N\n",
                std::sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]));
  }
  spm_client_disconnect(client);
  return read ? 0 : 1;
}
