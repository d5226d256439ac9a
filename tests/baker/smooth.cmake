# SPDX-License-Identifier: GPL-3.0-or-later
# What smoothing does to a surface before it is baked.
add_executable(smooth_tests full/map_filter_test.cpp smooth/smooth_test.cpp)
target_link_libraries(smooth_tests PRIVATE spm_baker spm_test_main TBB::tbb
                                           nlohmann_json::nlohmann_json)
spm_catch_tests(smooth_tests "smooth: ")
