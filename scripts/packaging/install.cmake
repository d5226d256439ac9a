# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts where, in components: bake, servo, query, client, dev, python. The
# same rules make the Debian packages (packages.cmake).
if(CMAKE_LIBRARY_ARCHITECTURE AND EXISTS /etc/debian_version)
  # Where Debian has libraries, below any prefix.
  set(CMAKE_INSTALL_LIBDIR lib/${CMAKE_LIBRARY_ARCHITECTURE} CACHE PATH "")
endif()
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(SPM_PYTHON_DIR lib/python3/dist-packages CACHE PATH "Folder of Python modules, below the prefix")
set(packaging ${CMAKE_SOURCE_DIR}/scripts/packaging)
set(spm_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/spm)

# Text whose paths depend on the prefix, which is known when it is installed: FOLDER below the
# prefix, or an absolute one.
function(spm_install_placed component folder file)
  install(CODE "set(component ${component})\nset(file ${file})\nset(folder ${folder})\nset(bindir ${CMAKE_INSTALL_BINDIR})"
          COMPONENT ${component})
  install(SCRIPT ${packaging}/place_file.cmake COMPONENT ${component})
endfunction()

# Programs, with their man pages and completion.
install(TARGETS spm-bake RUNTIME COMPONENT bake)
install(TARGETS spm-servo RUNTIME COMPONENT servo)
foreach(component bake servo)
  spm_install_placed(${component} share/man/man1 ${packaging}/spm-${component}.1)
  install(FILES ${packaging}/spm-completion.bash DESTINATION share/bash-completion/completions
          RENAME spm-${component} COMPONENT ${component})
endforeach()
install(FILES ${CMAKE_SOURCE_DIR}/scripts/charts/plot_recording.py ${CMAKE_SOURCE_DIR}/scripts/charts/chart_io.py
              ${CMAKE_SOURCE_DIR}/scripts/charts/chart_style.py ${CMAKE_SOURCE_DIR}/scripts/charts/recording_file.py
        DESTINATION share/spm-haptics COMPONENT servo)
# The pages, where scripts/build_page made them.
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/spm-haptics/view DESTINATION share/spm-haptics
        COMPONENT servo OPTIONAL PATTERN .sum EXCLUDE)
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/spm-haptics/report DESTINATION share/spm-haptics
        COMPONENT bake OPTIONAL PATTERN .sum EXCLUDE)
install(FILES ${packaging}/70-spm-haptics.rules DESTINATION lib/udev/rules.d COMPONENT servo)
spm_install_placed(servo lib/systemd/user ${packaging}/spm-servo.service)
spm_install_placed(servo lib/systemd/system ${packaging}/spm-servo-system.service)
spm_install_placed(servo etc/security/limits.d ${packaging}/95-spm-haptics.conf)

# Libraries, and what building with them takes.
foreach(library query client)
  install(TARGETS spm_${library} EXPORT spm LIBRARY COMPONENT ${library} NAMELINK_COMPONENT dev
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endforeach()
install(FILES ${CMAKE_SOURCE_DIR}/formats/query/spm_query.h ${CMAKE_SOURCE_DIR}/servo/client/spm_client.h
              ${CMAKE_SOURCE_DIR}/servo/client/spm_client_counts.h
              ${CMAKE_SOURCE_DIR}/servo/client/spm_client_live.h
        TYPE INCLUDE COMPONENT dev)
install(EXPORT spm NAMESPACE spm:: FILE spm-targets.cmake DESTINATION ${spm_package_dir} COMPONENT dev)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/spm-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${packaging}/spm-config.cmake ${packaging}/spm_add_assets.cmake
              ${CMAKE_BINARY_DIR}/package/spm-config-version.cmake
        DESTINATION ${spm_package_dir} COMPONENT dev)
file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
foreach(library query client)
  configure_file(${packaging}/library.pc.in ${CMAKE_BINARY_DIR}/package/spm-${library}.pc @ONLY)
  install(FILES ${CMAKE_BINARY_DIR}/package/spm-${library}.pc
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()
install(DIRECTORY ${CMAKE_SOURCE_DIR}/servo/client/csharp DESTINATION share/spm-haptics COMPONENT dev)

install(FILES ${CMAKE_SOURCE_DIR}/formats/query/python/spm_query.py
              ${CMAKE_SOURCE_DIR}/servo/client/python/spm_client.py
              ${CMAKE_SOURCE_DIR}/servo/client/python/spm_client_data.py
              ${CMAKE_SOURCE_DIR}/servo/client/python/spm_client_library.py
        DESTINATION ${SPM_PYTHON_DIR} COMPONENT python)

include(${packaging}/packages.cmake)
