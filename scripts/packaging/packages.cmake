# SPDX-License-Identifier: Apache-2.0
# Debian packages of the components of install.cmake: make_packages makes them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME spm-haptics)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
# Whoever makes the packages maintains them, and is named as Debian's own tools are told. Else nobody
# is, and the address says so: no host's name ends in .invalid (RFC 2606).
set(CPACK_PACKAGE_CONTACT "Local build of SPM Haptics <nobody@spm-haptics.invalid>")
if(DEFINED ENV{DEBEMAIL} AND DEFINED ENV{DEBFULLNAME})
  set(CPACK_PACKAGE_CONTACT "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_STRIP_FILES ON)
# Paths in files are those below /usr, wherever the files are gathered.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_COMPONENTS_ALL bake servo query client dev python)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(spm_debian ${CMAKE_BINARY_DIR}/package)
file(WRITE ${spm_debian}/changelog
     "spm-haptics (${PROJECT_VERSION}) unstable; urgency=low\n\n  * See the project's history.\n\n"
     " -- ${CPACK_PACKAGE_CONTACT}  Tue, 24 Nov 2026 12:00:00 +0000\n")

# What a library's package tells dpkg: the symbols of its list, and to look for libraries again.
function(spm_debian_library name list)
  string(REGEX REPLACE "^libspm-(.*)1$" "libspm_\\1" library ${name})
  file(STRINGS ${list} lines REGEX "^    spm_[a-z_]+;$")
  set(symbols "${library}.so.1 ${name} #MINVER#\n")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^ +(spm_[a-z_]+);?$" " \\1@Base ${PROJECT_VERSION}\n" line "${line}")
    string(APPEND symbols "${line}")
  endforeach()
  file(WRITE ${spm_debian}/${name}/symbols "${symbols}")
  file(WRITE ${spm_debian}/${name}/shlibs "${library} 1 ${name} (>= ${PROJECT_VERSION})\n")
  file(WRITE ${spm_debian}/${name}/triggers "activate-noawait ldconfig\n")
endfunction()
spm_debian_library(libspm-query1 ${CMAKE_SOURCE_DIR}/formats/query/spm_query.map)
spm_debian_library(libspm-client1 ${CMAKE_SOURCE_DIR}/servo/client/spm_client.map)
file(WRITE ${spm_debian}/spm-servo/conffiles "/etc/security/limits.d/95-spm-haptics.conf\n")
foreach(script postinst postrm)
  configure_file(${packaging}/debian/${script} ${spm_debian}/spm-servo/${script} COPYONLY)
endforeach()

# One package: its component, name, section, short description and long one, then fields.
function(spm_debian_package component name section short long)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${key}_DESCRIPTION "${short}\n${long}" PARENT_SCOPE)
  cmake_parse_arguments(PARSE_ARGV 5 field "SHLIBDEPS" "ARCHITECTURE;DEPENDS;RECOMMENDS;SUGGESTS" "CONTROL")
  foreach(field ARCHITECTURE DEPENDS RECOMMENDS SUGGESTS)
    if(field_${field})
      set(CPACK_DEBIAN_${key}_PACKAGE_${field} "${field_${field}}" PARENT_SCOPE)
    endif()
  endforeach()
  set(CPACK_DEBIAN_${key}_PACKAGE_SHLIBDEPS ${field_SHLIBDEPS} PARENT_SCOPE)
  list(TRANSFORM field_CONTROL PREPEND ${spm_debian}/${name}/)
  set(CPACK_DEBIAN_${key}_PACKAGE_CONTROL_EXTRA "${field_CONTROL}" PARENT_SCOPE)

  # What Debian wants to find of every package.
  set(licence Apache-2.0)
  if(component STREQUAL bake)
    set(licence GPL-3+)
  endif()
  install(FILES ${packaging}/debian/copyright.${licence} DESTINATION share/doc/${name} RENAME copyright
          COMPONENT ${component})
  spm_install_placed(${component} share/doc/${name} ${spm_debian}/changelog)
endfunction()

set(both "(= ${PROJECT_VERSION})")
spm_debian_package(
  bake spm-bake science "bake meshes for haptics"
  "Turns a triangle mesh into one file from which the signed distance of any
point near the surface is read in microseconds, with an error that is proven
to be below a tolerance. Batches of meshes are baked in parallel, with a
cache, in shards."
  SHLIBDEPS SUGGESTS "spm-servo, python3")
spm_debian_package(
  servo spm-servo science "serve forces to haptic devices"
  "Reads a force-feedback device a thousand times a second, computes the force
of the touched scene from files that spm-bake wrote, and sends it back. With
a simulated device and hand."
  SHLIBDEPS DEPENDS "adduser" RECOMMENDS "python3-matplotlib" SUGGESTS "spm-bake, rtkit"
  CONTROL conffiles postinst postrm)
spm_debian_package(
  query libspm-query1 libs "signed distance and force from baked meshes"
  "The library that answers how deep a point is in a baked object, and with
which force a probe is pushed out, for programs with a loop of their own."
  SHLIBDEPS CONTROL shlibs symbols triggers)
spm_debian_package(
  client libspm-client1 libs "applications beside the haptics daemon spm-servo"
  "The library with which a program reads what the hand does, moves objects and
sets effects, while spm-servo computes the force."
  SHLIBDEPS CONTROL shlibs symbols triggers)
spm_debian_package(
  dev libspm-dev libdevel "develop with SPM Haptics"
  "Headers, the CMake package spm, pkg-config files and C# sources of
libspm_query and libspm_client."
  DEPENDS "libspm-query1 ${both}, libspm-client1 ${both}" SUGGESTS "spm-bake, cmake, pkg-config")
spm_debian_package(
  python python3-spm python "SPM Haptics from Python"
  "The modules spm_query, which answers many points in one call, and
spm_client."
  ARCHITECTURE all DEPENDS "python3, libspm-query1 (>= ${PROJECT_VERSION}), libspm-client1 (>= ${PROJECT_VERSION})"
  RECOMMENDS "python3-numpy")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)
include(CPack)
