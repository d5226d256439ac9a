/* SPDX-License-Identifier: Apache-2.0 */
/* What a C program makes of the header alone; c_library_test.cpp compares it with C++. */
#include "c_client.h"

#include <stddef.h>

int c_client_open(const char* path, spm_query_asset** asset, char* message, size_t size) {
  return spm_query_open(path, asset, message, size);
}

spm_query_answer c_client_point(const spm_query_asset* asset, double x, double y, double z) {
  const double point[3] = {x, y, z};
  spm_query_answer answer;
  spm_query_point(asset, point, &answer);
  return answer;
}

int c_client_force(const spm_query_asset* asset, double stiffness, double radius, int method,
                   const double point[3], spm_query_contact* contact) {
  const spm_query_force_settings settings = {
      .stiffness = stiffness, .probe_radius = radius, .method = method};
  return spm_query_force(asset, &settings, point, contact);
}

int c_client_probe_force(const spm_query_asset* asset, double radius, double length,
                         const double axis[3], int form, const double point[3],
                         spm_query_contact* contact) {
  const spm_query_force_settings settings = {
      .stiffness = 800,
      .probe_radius = radius,
      .method = SPM_QUERY_METHOD_PAPER_PROBE,
      .probe = length != 0 ? SPM_QUERY_PROBE_CAPSULE : SPM_QUERY_PROBE_BALL,
      .probe_length = length,
      .probe_axis = {axis[0], axis[1], axis[2]},
      .form = form};
  return spm_query_force(asset, &settings, point, contact);
}
