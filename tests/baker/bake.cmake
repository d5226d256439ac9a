# SPDX-License-Identifier: GPL-3.0-or-later
add_executable(bake_tests pipeline/bake_accuracy_test.cpp pipeline/bake_test.cpp cast/cast_test.cpp cast/exact_tree_test.cpp charts/charts_test.cpp
                          field/corner_distances_test.cpp field/feature_sides_test.cpp
                          field/edge_bound_test.cpp field/edge_collapse_test.cpp field/octree_test.cpp field/surface_distance_test.cpp mesh/sliver_removal_test.cpp
                          pictures/export_test.cpp pictures/picture_legend_test.cpp
                          ../common/sixdof/object_quadrature_baked_test.cpp ../common/sixdof/surface_samples_baked_test.cpp
                          ../support/asset_by_hand.cpp)
target_link_libraries(bake_tests PRIVATE spm_baker spm_test_main)
spm_catch_tests(bake_tests "bake: ")
