/* SPDX-License-Identifier: Apache-2.0 */
/* How deep a point is in an asset, and how hard it is pushed out: touch ASSET X Y Z. */
#include <spm_query.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  spm_query_asset* asset = NULL;
  char message[512];
  int code;
  if (argc != 5) return 1;
  code = spm_query_open(argv[1], &asset, message, sizeof message);
  if (code != 0) {
    fprintf(stderr, "%s\n", message);
    return code;
  }
  const double point[3] = {atof(argv[2]), atof(argv[3]), atof(argv[4])};
  const spm_query_force_settings settings = {.stiffness = 1000};
  spm_query_answer answer;
  spm_query_contact contact;
  spm_query_point(asset, point, &answer);
  code = spm_query_force(asset, &settings, point, &contact);
  printf("%.6f m, %.3f N\n", answer.distance, contact.depth * settings.stiffness);
  spm_query_close(asset);
  return code;
}
