# SPDX-License-Identifier: GPL-3.0-or-later
# Batches: what a manifest asks for, and who bakes it.
add_executable(batch_tests batch/manifest_test.cpp batch/workers_test.cpp)
target_link_libraries(batch_tests PRIVATE spm_baker_batch spm_test_main nlohmann_json::nlohmann_json)
spm_catch_tests(batch_tests "batch: ")
