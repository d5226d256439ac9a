# SPDX-License-Identifier: Apache-2.0
# spm_add_assets(target MANIFEST FILE [CACHE FOLDER] [JOBS N] [OPTIONS OPTION...]): a target that
# bakes the assets of a manifest, as `spm-bake batch` does. Let what needs them depend on it:
#   spm_add_assets(assets MANIFEST assets.toml)
#   add_dependencies(game assets)
# It is a part of `all` and is run in every build, since only spm-bake knows what a manifest comes
# to: what is right already is found in the cache (default: spm-cache in the build folder) and left
# alone. OPTIONS are further ones of `batch`, such as --remote-cache URL.
function(spm_add_assets target)
  cmake_parse_arguments(PARSE_ARGV 1 assets "" "MANIFEST;CACHE;JOBS" "OPTIONS")
  if(NOT assets_MANIFEST OR assets_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "spm_add_assets: say spm_add_assets(target MANIFEST FILE [CACHE FOLDER] [JOBS N] [OPTIONS OPTION...])")
  endif()
  if(NOT SPM_BAKE)
    message(FATAL_ERROR "spm_add_assets: spm-bake was not found; install it or set SPM_BAKE to its path")
  endif()
  get_filename_component(manifest ${assets_MANIFEST} ABSOLUTE)
  if(NOT EXISTS ${manifest})
    message(FATAL_ERROR "spm_add_assets: there is no ${manifest}; check the name")
  endif()
  if(NOT assets_CACHE)
    set(assets_CACHE ${CMAKE_BINARY_DIR}/spm-cache)
  endif()
  if(NOT assets_JOBS)
    set(assets_JOBS 1)
  endif()
  add_custom_target(
    ${target} ALL
    COMMAND ${SPM_BAKE} batch ${manifest} -j ${assets_JOBS} --cache ${assets_CACHE} ${assets_OPTIONS}
    COMMENT "Assets of ${assets_MANIFEST}"
    USES_TERMINAL VERBATIM)
  set_property(TARGET ${target} APPEND PROPERTY SOURCES ${manifest})
endfunction()
