/* SPDX-License-Identifier: Apache-2.0 */
/* Moves an object up and down under the tool that the first device's hand holds (a scene with
 * `[tool] asset`), and prints where the tool lies, where it touches, and what the tools do to the
 * object.
 * Usage: spm_client_move_under_tool [SOCKET [OBJECT [SECONDS [MILLIMETRES]]]] */
#include <math.h>
#include <spm_client.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const double rate = 60;       /* poses a second */
static const double frequency = 0.5; /* 1/s */

static double size_of(const double* vector) {
  return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
}

/* Returns the library's code. */
static int print_contacts(const spm_client* client, uint64_t object) {
  spm_client_device hand = {.size = sizeof hand};
  spm_client_object moved = {.size = sizeof moved};
  spm_client_contact contacts[SPM_CLIENT_MAX_CONTACTS] = {{.size = sizeof contacts[0]}};
  size_t count = 0;
  int code = spm_client_read_device(client, 0, &hand);
  if (code == SPM_CLIENT_OK) code = spm_client_read_object(client, object, &moved);
  if (code == SPM_CLIENT_OK) {
    code = spm_client_read_contacts(client, 0, NULL, contacts, SPM_CLIENT_MAX_CONTACTS, &count);
  }
  if (code != SPM_CLIENT_OK) return code;
  printf(
      "tool at %.2f %.2f %.2f mm touches at %zu places; object %llu: reaction %.2f N, %.4f N m\n",
      hand.tool_position[0] * 1e3, hand.tool_position[1] * 1e3, hand.tool_position[2] * 1e3, count,
      (unsigned long long)object, size_of(moved.force), size_of(moved.torque));
  for (size_t i = 0; i < count; ++i) {
    printf("  at %.2f %.2f %.2f mm on object %llu: %.2f N, %.3f mm deep\n",
           contacts[i].place[0] * 1e3, contacts[i].place[1] * 1e3, contacts[i].place[2] * 1e3,
           (unsigned long long)contacts[i].object, size_of(contacts[i].force),
           contacts[i].depth * 1e3);
  }
  return SPM_CLIENT_OK;
}

int main(int argc, char** argv) {
  const spm_client_options options = {.size = sizeof options,
                                      .path = argc > 1 ? argv[1] : NULL,
                                      .application = "move_under_tool example"};
  const uint64_t object = argc > 2 ? strtoull(argv[2], NULL, 10) : 0;
  const double seconds = argc > 3 ? atof(argv[3]) : 10;
  const double amplitude = argc > 4 ? atof(argv[4]) * 1e-3 : 2e-3;
  spm_client* client = NULL;
  char message[512];
  if (spm_client_connect(&options, &client, message, sizeof message) != SPM_CLIENT_OK) {
    fprintf(stderr, "error: %s\n", message);
    return 2;
  }
  spm_client_object start = {.size = sizeof start};
  int code = spm_client_wait_tick(client, 0, 1.0, NULL);
  if (code == SPM_CLIENT_OK) code = spm_client_read_object(client, object, &start);
  spm_client_pose pose = {.size = sizeof pose, .period = 1 / rate};
  for (int i = 0; i < 3; ++i) pose.position[i] = start.position[i];
  for (int i = 0; i < 4; ++i) pose.orientation[i] = start.orientation[i];
  for (int frame = 0; frame < (int)(seconds * rate) && code == SPM_CLIENT_OK; ++frame) {
    pose.position[1] =
        start.position[1] + amplitude * sin(2 * 3.14159265358979 * frequency * frame / rate);
    code = spm_client_move_object(client, object, &pose);
    if (code == SPM_CLIENT_OK && frame % 6 == 0) code = print_contacts(client, object);
    const struct timespec wait = {0, (long)(1e9 / rate)};
    nanosleep(&wait, NULL);
  }
  spm_client_disconnect(client);
  if (code != SPM_CLIENT_OK) {
    fprintf(stderr, "error: no such object, or no tick any more (code %d): look at the daemon\n",
            code);
    return 3;
  }
  return 0;
}
