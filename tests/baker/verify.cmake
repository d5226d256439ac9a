# SPDX-License-Identifier: GPL-3.0-or-later
# The reference that assets are measured against, and the measuring.
add_executable(verify_tests report/report_page_test.cpp verify/border_jumps_test.cpp verify/exact_surface_test.cpp verify/exact_winding_test.cpp mesh/winding_number_test.cpp verify/render_test.cpp
                            verify/verify_test.cpp)
target_link_libraries(verify_tests PRIVATE spm_baker spm_test_main)
spm_catch_tests(verify_tests "verify: ")
