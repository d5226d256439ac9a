# SPDX-License-Identifier: Apache-2.0
# Catch of either interface: spm_catch links it, and <catch2/catch.hpp> is its header; that of
# Catch 3 is ours.
find_package(Catch2 REQUIRED)
include(Catch)
add_library(spm_catch INTERFACE)
target_link_libraries(spm_catch INTERFACE Catch2::Catch2)
set(SPM_CATCH_DISCOVERY "" CACHE INTERNAL "")
if(Catch2_VERSION VERSION_GREATER_EQUAL 3)
  # Else its own exit code for skips would stand in place of ours (ctest.cmake).
  set(SPM_CATCH_DISCOVERY SKIP_IS_FAILURE CACHE INTERNAL "")
  target_include_directories(spm_catch INTERFACE ${CMAKE_CURRENT_LIST_DIR}/support/catch3)
endif()
