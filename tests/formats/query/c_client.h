/* SPDX-License-Identifier: Apache-2.0 */
#ifndef SPM_TESTS_C_CLIENT_H
#define SPM_TESTS_C_CLIENT_H

#include "spm_query.h"

#ifdef __cplusplus
extern "C" {
#endif

int c_client_open(const char* path, spm_query_asset** asset, char* message, size_t size);
spm_query_answer c_client_point(const spm_query_asset* asset, double x, double y, double z);
int c_client_force(const spm_query_asset* asset, double stiffness, double radius, int method,
                   const double point[3], spm_query_contact* contact);

/** By SPM_QUERY_METHOD_PAPER_PROBE, 800 N/m; a length of 0 is a ball. */
int c_client_probe_force(const spm_query_asset* asset, double radius, double length,
                         const double axis[3], int form, const double point[3],
                         spm_query_contact* contact);

#ifdef __cplusplus
}
#endif

#endif
