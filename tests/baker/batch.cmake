# SPDX-License-Identifier: GPL-3.0-or-later
# Batches: what a manifest asks for, who bakes it, and what need not be baked again.
add_executable(batch_tests batch/depfile_test.cpp batch/manifest_test.cpp batch/merge_test.cpp
                           batch/scenes_test.cpp batch/shards_test.cpp batch/workers_test.cpp
                           cache/cache_key_test.cpp cache/cache_test.cpp cache/entry_check_test.cpp
                           pipeline/algorithm_version_test.cpp)
target_link_libraries(batch_tests PRIVATE spm_baker_batch spm_test_main nlohmann_json::nlohmann_json)
spm_catch_tests(batch_tests "batch: ")
