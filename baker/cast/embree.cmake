# SPDX-License-Identifier: GPL-3.0-or-later
# Embree of either interface: spm_embree links it, and <embree/rays.hpp> is embree3_rays.hpp or
# embree4_rays.hpp.
find_package(embree REQUIRED)
if(NOT embree_VERSION MATCHES "^[34]\\.")
  message(FATAL_ERROR "Embree ${embree_VERSION} in ${embree_DIR} is neither 3 nor 4")
endif()
string(REGEX MATCH "^[0-9]+" spm_embree_version ${embree_VERSION})
file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/interfaces/embree/rays.hpp
     CONTENT "#include \"baker/cast/embree${spm_embree_version}_rays.hpp\"\n")
add_library(spm_embree INTERFACE)
target_include_directories(spm_embree INTERFACE ${CMAKE_BINARY_DIR}/interfaces)
target_link_libraries(spm_embree INTERFACE embree)
