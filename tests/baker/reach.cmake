# SPDX-License-Identifier: GPL-3.0-or-later
# What a device and a scene leave of a model.
add_executable(reach_tests reach/reach_test.cpp commands/scene_limits_test.cpp)
target_link_libraries(reach_tests PRIVATE spm_baker_commands spm_baker spm_test_main TBB::tbb)
spm_catch_tests(reach_tests "reach: ")
