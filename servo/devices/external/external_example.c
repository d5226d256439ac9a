/* SPDX-License-Identifier: Apache-2.0 */
/* Provides a device whose vendor's library is closed to spm-servo. As it stands, the tool moves to
 * and fro by itself along z, 5 mm about a point, so that it can be tried without a device. Put the
 * vendor's calls where the comments say VENDOR.
 *
 *   spm-servo run --asset demo.spm.exr --device external:name=demo &
 *   external_example demo 10 0 0 0.04
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "spm_external.h"

int main(int argc, char** argv) {
  if (argc != 6) {
    fprintf(stderr, "usage: %s NAME SECONDS X Y Z (metres)\n", argv[0]);
    return 1;
  }
  const double middle[3] = {atof(argv[3]), atof(argv[4]), atof(argv[5])};
  const long ticks = (long)(1000 * atof(argv[2]));
  char message[1024];
  struct spm_external device;
  if (spm_external_open(&device, argv[1], message, sizeof message) != 0) {
    fprintf(stderr, "error: %s\n", message);
    return 2;
  }
  /* VENDOR: open the device, and start its servo loop; what follows is that loop's body. */
  double largest = 0, force[3] = {0, 0, 0}, torque[3] = {0, 0, 0};
  long silent = 0;
  for (long tick = 0; tick < ticks; ++tick) {
    /* VENDOR: read the pose. Turn its axes to x right, y up, z towards the user, and its lengths to
     * metres. */
    const double position[3] = {middle[0], middle[1],
                                middle[2] + 0.005 * cos(6.283185307179586 * (double)tick / 1000)};
    const double orientation[4] = {1, 0, 0, 0};
    spm_external_put_pose(&device, position, orientation, 0);
    if (!spm_external_get_wrench(&device, force, torque)) ++silent;
    /* VENDOR: apply force and torque; they are zero once the daemon is silent. */
    const double size = sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
    if (size > largest) largest = size;
    const struct timespec pause = {0, 1000000};
    nanosleep(&pause, NULL);
  }
  /* VENDOR: zero force, close the device. */
  printf("largest force %.3f N, the daemon was silent in %ld of %ld ticks\n", largest, silent,
         ticks);
  spm_external_close(&device);
  return 0;
}
