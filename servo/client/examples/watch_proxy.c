/* SPDX-License-Identifier: Apache-2.0 */
/* Waits for each tick of the loop, and prints the first device's place, that of its proxy, where
 * the surface holds the tool, and the force, which it holds below a cap. After a fault that the
 * daemon wants acknowledged (run --recovery acknowledge) it acknowledges it: do that only where you
 * have looked whether all is well again. */
#include <spm_client.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  const spm_client_options options = {.size = sizeof options,
                                      .path = argc > 1 ? argv[1] : NULL,
                                      .application = "watch_proxy example"};
  const int ticks = argc > 2 ? atoi(argv[2]) : 1000;
  const double cap = argc > 3 ? atof(argv[3]) : 2; /* N */
  spm_client* client = NULL;
  char message[512];
  if (spm_client_connect(&options, &client, message, sizeof message) != SPM_CLIENT_OK) {
    fprintf(stderr, "error: %s\n", message);
    return 2;
  }
  int code = spm_client_set_force_cap(client, 0, cap);
  spm_client_tick tick = {.size = sizeof tick};
  for (int i = 0; i < ticks && code == SPM_CLIENT_OK; ++i) {
    code = spm_client_wait_tick(client, tick.tick, 1.0, &tick);
    spm_client_device hand = {.size = sizeof hand};
    if (code == SPM_CLIENT_OK) code = spm_client_read_device(client, 0, &hand);
    if (code != SPM_CLIENT_OK) break;
    printf("tick %llu: hand %.2f %.2f %.2f mm, proxy %.2f %.2f %.2f mm, force %.2f %.2f %.2f N\n",
           (unsigned long long)hand.tick, hand.position[0] * 1e3, hand.position[1] * 1e3,
           hand.position[2] * 1e3, hand.proxy[0] * 1e3, hand.proxy[1] * 1e3, hand.proxy[2] * 1e3,
           hand.force[0], hand.force[1], hand.force[2]);
    if (hand.cause == SPM_CLIENT_OFF_UNACKNOWLEDGED) code = spm_client_acknowledge(client, 0);
  }
  spm_client_disconnect(client);
  if (code != SPM_CLIENT_OK) {
    fprintf(stderr, "error: no tick or no device any more (code %d): look at the daemon\n", code);
    return 3;
  }
  return 0;
}
