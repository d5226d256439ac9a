# SPDX-License-Identifier: GPL-3.0-or-later
add_executable(bake_tests pipeline/bake_accuracy_test.cpp ../common/index/element_index_test.cpp pipeline/bake_test.cpp cast/cast_test.cpp
                          trials/direction_error_test.cpp pictures/export_test.cpp trees/elements_test.cpp
                          ../common/sixdof/overlap_volume_baked_test.cpp ../common/sixdof/surface_samples_baked_test.cpp
                          tiles/tiles_test.cpp)
target_link_libraries(bake_tests PRIVATE spm_baker spm_test_main)
spm_catch_tests(bake_tests "bake: ")
