# SPDX-License-Identifier: GPL-3.0-or-later
# What a device and a scene leave of a model.
add_executable(reachability_tests reachability/reachability_test.cpp build/scene_limits_test.cpp)
target_link_libraries(reachability_tests PRIVATE spm_baker_commands spm_baker spm_test_main TBB::tbb)
spm_catch_tests(reachability_tests "reachability: ")
