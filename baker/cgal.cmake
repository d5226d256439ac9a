# SPDX-License-Identifier: GPL-3.0-or-later
# CGAL of either interface: spm_cgal links it, and <cgal/trees.hpp> is verify/cgal5_trees.hpp or
# verify/cgal6_trees.hpp. CGAL's files look for Boost by CMake's module, which newer CMakes give up and
# warn of, unless they are told to take Boost's own files.
set(CMAKE_POLICY_DEFAULT_CMP0167 NEW)
find_package(CGAL REQUIRED)
if(NOT CGAL_VERSION MATCHES "^[56]\\.")
  message(FATAL_ERROR "CGAL ${CGAL_VERSION} in ${CGAL_DIR} is neither 5 nor 6")
endif()
if(NOT TARGET spm_cgal)
  # Its searches then can use all cores.
  target_compile_definitions(CGAL INTERFACE CGAL_LINKED_WITH_TBB)
  string(REGEX MATCH "^[0-9]+" spm_cgal_version ${CGAL_VERSION})
  file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/interfaces/cgal/trees.hpp
       CONTENT "#include \"baker/verify/cgal${spm_cgal_version}_trees.hpp\"\n")
  add_library(spm_cgal INTERFACE)
  target_include_directories(spm_cgal INTERFACE ${CMAKE_BINARY_DIR}/interfaces)
  target_link_libraries(spm_cgal INTERFACE CGAL::CGAL)
  if(CGAL_VERSION VERSION_LESS 6 AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    # Templates of CGAL 5 that nobody uses call what is not there, which clang 19 looks for.
    target_compile_options(CGAL INTERFACE -fdelayed-template-parsing
                                          -Wno-unknown-warning-option
                                          -Wno-delayed-template-parsing-in-cxx20)
  endif()
endif()
