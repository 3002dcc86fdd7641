# SPDX-License-Identifier: Apache-2.0
find_package(GTest REQUIRED)
engram_precompiled_kind(tests PROGRAM LINK GTest::gmock)
if(ENGRAM_LEARNING)
  engram_precompiled_kind(learning_tests PROGRAM LINK GTest::gmock torch)
endif()

# engram_add_test(store_test SOURCES a_test.cpp LINK engram::store LABELS fast)
#
# One GoogleTest program of a room is one ctest, so that LibTorch and OpenCV are loaded once for all
# of its tests, not for each: that took a third of the time of 2,500. Where they take minutes, SHARDS
# ctests run a share of them each, beside each other. LABELS default to fast. What takes longest has a
# COST in seconds, so that it starts first and no core waits for the last of them.
#
# Its sources are compiled together, as those of rooms are (ENGRAM_UNITY): each of them alone would
# instantiate the same templates of GoogleTest and LibTorch, which takes 5 to 12 s of processor time.
# Those after APART are compiled alone, because their names clash with others.
function(engram_add_test name)
  cmake_parse_arguments(ARG "" "SHARDS;COST" "SOURCES;APART;LINK;LABELS" ${ARGN})
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "engram_add_test(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT ARG_LABELS)
    set(ARG_LABELS fast)
  endif()
  add_executable(${name} ${ARG_SOURCES} ${ARG_APART})
  if(ARG_APART)
    set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gmock GTest::gtest_main)
  # LibTorch defines macros that a precompiled header must have been made with.
  if(torch IN_LIST ARG_LINK)
    engram_precompiled(${name} learning_tests)
  else()
    engram_precompiled(${name} tests)
  endif()
  if(ENGRAM_UNITY)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    # Types of unnamed namespaces in included files are meant to be there.
    target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  target_compile_definitions(${name} PRIVATE ENGRAM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  if(NOT ARG_SHARDS)
    set(ARG_SHARDS 1)
  endif()
  math(EXPR last_shard "${ARG_SHARDS} - 1")
  foreach(shard RANGE ${last_shard})
    set(test ${name})
    if(ARG_SHARDS GREATER 1)
      string(APPEND test _${shard})
    endif()
    add_test(NAME ${test} COMMAND ${name})
    if(ARG_COST)
      set_tests_properties(${test} PROPERTIES COST ${ARG_COST})
    endif()
    # Tests run beside each other: waiting threads must not spin for long (cli/learning_environment.h).
    set_tests_properties(${test} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT 1800
      ENVIRONMENT "OMP_WAIT_POLICY=passive;GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()
