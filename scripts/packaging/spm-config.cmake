# SPDX-License-Identifier: Apache-2.0
# find_package(spm) gives the targets spm::query and spm::client, and spm_add_assets(). Components
# that may be asked for: query, client, assets (which needs the program spm-bake).
include(${CMAKE_CURRENT_LIST_DIR}/spm-targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/spm_add_assets.cmake)
find_program(SPM_BAKE spm-bake HINTS ${CMAKE_CURRENT_LIST_DIR}/../../../bin ${CMAKE_CURRENT_LIST_DIR}/../../../../bin
             DOC "The program that bakes meshes")
set(spm_query_FOUND TRUE)
set(spm_client_FOUND TRUE)
set(spm_assets_FOUND FALSE)
if(SPM_BAKE)
  set(spm_assets_FOUND TRUE)
endif()
foreach(component IN LISTS spm_FIND_COMPONENTS)
  if(spm_FIND_REQUIRED_${component} AND NOT spm_${component}_FOUND)
    set(spm_FOUND FALSE)
    set(spm_NOT_FOUND_MESSAGE "component ${component} is not there")
    if(component STREQUAL "assets")
      string(APPEND spm_NOT_FOUND_MESSAGE ": spm-bake was not found; install it or set SPM_BAKE")
    endif()
  endif()
endforeach()
