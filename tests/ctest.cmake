# SPDX-License-Identifier: Apache-2.0
# How tests are made known to ctest, so that it counts and names those that a machine cannot run.

# What a test program ends with where it skipped a test (tests/support/skip.hpp, python_tests.py).
# A code and no regular expression: that one would call a test skipped that also failed.
set(SPM_SKIP_CODE 77 CACHE INTERNAL "")
set(SPM_PYTHON_TESTS ${CMAKE_CURRENT_LIST_DIR}/support/python_tests.py CACHE INTERNAL "")

# Every test case of a Catch program: spm_catch_tests(target "prefix: " [property value]...).
function(spm_catch_tests target prefix)
  # A name that the program does not know, such as half of one with a semicolon, is a failure.
  catch_discover_tests(${target} ${SPM_CATCH_DISCOVERY} TEST_PREFIX "${prefix}"
                       EXTRA_ARGS --warn NoTests
                       PROPERTIES SKIP_RETURN_CODE ${SPM_SKIP_CODE} ${ARGN})
endfunction()

# A file of unittest tests: spm_python_tests(name file [ARGUMENTS a...] [ENVIRONMENT NAME=VALUE...]
# [DEBIAN] [ALONE Class.test...]). A test that is ALONE gets an entry of its own: name it where a
# machine often lacks what it needs, else its skip is that of the whole file. DEBIAN tests import
# modules of Debian's packages, which another interpreter on the machine would not find.
function(spm_python_tests name file)
  cmake_parse_arguments(PARSE_ARGV 2 tests "DEBIAN" "" "ARGUMENTS;ENVIRONMENT;ALONE")
  find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)
  get_filename_component(path ${file} ABSOLUTE)
  set(interpreter Python3::Interpreter)
  if(tests_DEBIAN AND EXISTS /usr/bin/python3)
    set(interpreter /usr/bin/python3)
  endif()
  set(command ${interpreter} -B ${SPM_PYTHON_TESTS})
  set(entries "${name}")
  set(without "")
  foreach(test IN LISTS tests_ALONE)
    add_test(NAME "${name}: ${test}" COMMAND ${command} ${path} ${tests_ARGUMENTS} ${test})
    list(APPEND entries "${name}: ${test}")
    list(APPEND without --without ${test})
  endforeach()
  add_test(NAME "${name}" COMMAND ${command} ${without} ${path} ${tests_ARGUMENTS})
  set_tests_properties(
    ${entries} PROPERTIES SKIP_RETURN_CODE ${SPM_SKIP_CODE}
                          ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1;${tests_ENVIRONMENT}")
endfunction()
