# SPDX-License-Identifier: GPL-3.0-or-later
add_executable(bake_tests bake_accuracy_test.cpp element_index_test.cpp bake_test.cpp cast_test.cpp
                          direction_error_test.cpp export_test.cpp elements_test.cpp
                          overlap_volume_test.cpp surface_samples_test.cpp
                          tiles_test.cpp)
target_link_libraries(bake_tests PRIVATE spm_baker spm_test_main)
catch_discover_tests(bake_tests TEST_PREFIX "bake: ")
