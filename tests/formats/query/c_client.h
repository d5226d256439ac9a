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

#ifdef __cplusplus
}
#endif

#endif
