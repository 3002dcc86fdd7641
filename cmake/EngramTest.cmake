# SPDX-License-Identifier: Apache-2.0
include(GoogleTest)
find_package(GTest REQUIRED)
engram_precompiled_kind(tests PROGRAM LINK GTest::gmock)
if(ENGRAM_LEARNING)
  engram_precompiled_kind(learning_tests PROGRAM LINK GTest::gmock torch)
endif()

# engram_add_test(store_test SOURCES a_test.cpp LINK engram::store LABELS fast)
#
# One GoogleTest program of a room; each TEST becomes a ctest, or the program as a WHOLE where its
# tests share something costly. LABELS default to fast.
function(engram_add_test name)
  cmake_parse_arguments(ARG "WHOLE" "" "SOURCES;LINK;LABELS" ${ARGN})
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "engram_add_test(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT ARG_LABELS)
    set(ARG_LABELS fast)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gmock GTest::gtest_main)
  # LibTorch defines macros that a precompiled header must have been made with.
  if(torch IN_LIST ARG_LINK)
    engram_precompiled(${name} learning_tests)
  else()
    engram_precompiled(${name} tests)
  endif()
  target_compile_definitions(${name} PRIVATE ENGRAM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  # Tests run beside each other: waiting threads must not spin for long (cli/learning_environment.h).
  set(environment ENVIRONMENT GOMP_SPINCOUNT=10000)
  if(ARG_WHOLE)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 900 ${environment})
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 600
                                             ${environment})
endfunction()
