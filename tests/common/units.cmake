# SPDX-License-Identifier: Apache-2.0
add_executable(units_test units_test.cpp)
target_link_libraries(units_test PRIVATE spm_common spm_test_main)
catch_discover_tests(units_test TEST_PREFIX "units: ")
