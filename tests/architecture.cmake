# SPDX-License-Identifier: Apache-2.0
# Tests of the project as a whole: its layout, and the models it generates.

# Writes "target: what it links" for the given targets and all that they reach, one a line.
function(spm_write_link_graph file)
  set(open ${ARGN})
  set(done "")
  set(text "")
  while(open)
    list(POP_FRONT open target)
    list(APPEND done "${target}")
    set(linked "")
    foreach(property LINK_LIBRARIES INTERFACE_LINK_LIBRARIES)
      get_target_property(names ${target} ${property})
      if(names)
        # $<LINK_ONLY:name> is how a static library carries what it links privately.
        string(REGEX REPLACE "\\$<LINK_ONLY:([^>]*)>" "\\1" names "${names}")
        list(APPEND linked ${names})
      endif()
    endforeach()
    list(REMOVE_DUPLICATES linked)
    foreach(name IN LISTS linked)
      if(TARGET "${name}" AND NOT name IN_LIST done AND NOT name IN_LIST open)
        list(APPEND open "${name}")
      endif()
    endforeach()
    string(REPLACE ";" " " linked "${linked}")
    string(APPEND text "${target}: ${linked}\n")
  endwhile()
  file(WRITE ${file} "${text}")
endfunction()

spm_write_link_graph(${CMAKE_BINARY_DIR}/link-graph.txt spm-bake spm-servo spm_query
                     spm_query_example spm_client spm_client_example)

get_property(rooms GLOBAL PROPERTY spm_rooms)
list(JOIN rooms "\n" rooms)
file(WRITE ${CMAKE_BINARY_DIR}/rooms.txt "${rooms}\n")

spm_python_tests("The layout, links and licences are the agreed ones" architecture_test.py
                 ARGUMENTS ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR})
find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)
add_test(NAME "The generated models are closed, outward and of the right volume"
         COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_SOURCE_DIR}/models/generate.py --check
                 --out ${CMAKE_BINARY_DIR}/models)
add_test(NAME "The figures on the pages are those of the JSON files"
         COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/figures_test.py
                 ${CMAKE_SOURCE_DIR})
add_test(NAME "Meshes made by seed are closed, and what was proven of them is not done again"
         COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/prove_served_test.py
                 ${CMAKE_SOURCE_DIR})
add_test(NAME "A trial of a release reads what the page, ctest and apt say"
         COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/test_release_test.py
                 ${CMAKE_SOURCE_DIR})
add_test(NAME "A measurement that was broken off goes on where it was"
         COMMAND ${Python3_EXECUTABLE} -B ${CMAKE_CURRENT_LIST_DIR}/measure_test.py
                 ${CMAKE_SOURCE_DIR})
