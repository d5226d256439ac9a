# SPDX-License-Identifier: Apache-2.0
# Installs one text file, whose paths are those of this prefix: /usr/local/bin becomes the folder of
# the programs. Man pages and changelogs are compressed, as Debian has them. Settings of a system
# whose programs are in /usr are in /etc.
set(prefix ${CMAKE_INSTALL_PREFIX})
if(folder MATCHES "^etc/" AND prefix STREQUAL "/usr")
  set(prefix "")
endif()
get_filename_component(name ${file} NAME)
set(target "$ENV{DESTDIR}${prefix}/${folder}/${name}")
message(STATUS "Installing: ${target}")
file(READ ${file} text)
string(REPLACE "/usr/local/bin/" "${CMAKE_INSTALL_PREFIX}/${bindir}/" text "${text}")
file(WRITE ${target} "${text}")
if(name MATCHES "\\.1$|^changelog$")
  execute_process(COMMAND gzip -9nf ${target} COMMAND_ERROR_IS_FATAL ANY)
  set(target ${target}.gz)
endif()
file(CHMOD ${target} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${target})
