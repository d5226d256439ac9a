/* SPDX-License-Identifier: Apache-2.0 */
/* Prints what the first device does, ten times a second: position, force and contact. If the force
 * is zero, it also prints why and what to do about it. With a third argument it pushes the hand up
 * by so many newtons meanwhile; the push ends when the program does. */
#include <spm_client.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static void wait_a_little(void) {
  const struct timespec tenth = {.tv_sec = 0, .tv_nsec = 100000000};
  nanosleep(&tenth, NULL);
}

static void print_device(const spm_client* client, const spm_client_device* device) {
  printf("tick %llu: at %.2f %.2f %.2f mm, force %.2f %.2f %.2f N%s",
         (unsigned long long)device->tick, device->position[0] * 1e3, device->position[1] * 1e3,
         device->position[2] * 1e3, device->force[0], device->force[1], device->force[2],
         device->contact ? ", in contact" : "");
  if (device->cause != SPM_CLIENT_FORCE_ON) {
    const char *name, *cure;
    spm_client_cause(client, device->cause, &name, &cure);
    printf(", no force (%s): %s", name, cure);
  }
  printf("\n");
  fflush(stdout);
}

int main(int argc, char** argv) {
  if (argc == 2 && strcmp(argv[1], "--help") == 0) {
    printf(
        "usage: %s [SOCKET [TIMES [NEWTONS]]]\n"
        "Prints the state of the daemon's first device, ten times a second, and pushes its hand "
        "up.\n",
        argv[0]);
    return 0;
  }
  const spm_client_options options = {.size = sizeof options,
                                      .path = argc > 1 ? argv[1] : NULL,
                                      .application = "read_state example"};
  const int times = argc > 2 ? atoi(argv[2]) : 50;
  const spm_client_push push = {
      .size = sizeof push, .force = {0, argc > 3 ? atof(argv[3]) : 0, 0}, .hold = 0.3};
  spm_client* client = NULL;
  char message[512];
  if (spm_client_connect(&options, &client, message, sizeof message) != SPM_CLIENT_OK) {
    fprintf(stderr, "error: %s\n", message);
    return 2;
  }
  int state = SPM_CLIENT_RUNNING;
  for (int i = 0; i < times && state != SPM_CLIENT_ENDED && state != SPM_CLIENT_GONE; ++i) {
    spm_client_device device = {.size = sizeof device};
    if (spm_client_read_device(client, 0, &device) == SPM_CLIENT_OK) print_device(client, &device);
    if (argc > 3 && spm_client_push_hand(client, 0, &push) == SPM_CLIENT_BAD_ARGUMENT) {
      fprintf(stderr, "error: %s is no force that can be sent: give up to 1000 N\n", argv[3]);
      spm_client_disconnect(client);
      return 1;
    }
    wait_a_little();
    state = spm_client_daemon_state(client, NULL);
  }
  spm_client_disconnect(client);
  return 0;
}
