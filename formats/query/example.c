/* SPDX-License-Identifier: Apache-2.0 */
/* Walks a line of points from outside an asset's box to its centre and prints what a probe would
 * feel: distance, normal and the force of a spring of 1 N/mm. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "spm_query.h"

static const char* const status_names[] = {"exact", "deep", "far", "pruned"};

static void walk(const spm_query_asset* asset, int steps) {
  double box_min[3], box_max[3], max_depth, margin;
  const spm_query_force_settings settings = {.stiffness = 1000};
  spm_query_box(asset, box_min, box_max);
  spm_query_band(asset, &max_depth, &margin);

  printf("z_mm,distance_mm,nx,ny,nz,force_n,status\n");
  for (int step = 0; step <= steps; ++step) {
    const double top = box_max[2] + margin;
    const double centre = 0.5 * (box_min[2] + box_max[2]);
    const double point[3] = {0.5 * (box_min[0] + box_max[0]), 0.5 * (box_min[1] + box_max[1]),
                             top + (centre - top) * step / steps};
    spm_query_answer answer;
    spm_query_contact contact;
    spm_query_point(asset, point, &answer);
    if (spm_query_force(asset, &settings, point, &contact) != 0) {
      fprintf(stderr, "the force settings do not suit this asset\n");
      return;
    }
    printf("%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%s\n", point[2] * 1e3, answer.distance * 1e3,
           answer.normal[0], answer.normal[1], answer.normal[2], contact.depth * settings.stiffness,
           status_names[answer.status]);
  }
}

int main(int argc, char** argv) {
  if (argc == 2 && strcmp(argv[1], "--help") == 0) {
    printf(
        "usage: %s FILE.spm.exr [STEPS]\n"
        "Walks from above the object to the centre of its box and prints, as CSV, the signed\n"
        "distance, the normal and the force on a point probe at 1 N/mm.\n",
        argv[0]);
    return 0;
  }
  const int steps = argc == 3 ? atoi(argv[2]) : 50;
  if (argc < 2 || argc > 3 || steps < 1) {
    fprintf(stderr, "usage: %s FILE.spm.exr [STEPS, 1 or more]\n", argv[0]);
    return 1;
  }
  spm_query_asset* asset = NULL;
  char message[512];
  const int code = spm_query_open(argv[1], &asset, message, sizeof message);
  if (code != 0) {
    fprintf(stderr, "error: %s\n", message);
    return code;
  }
  walk(asset, steps);
  spm_query_close(asset);
  return 0;
}
