# SPDX-License-Identifier: Apache-2.0

# Headers that are parsed once and not in each source: half of what a small source costs is the
# standard library, fmt and JSON, and LibTorch costs 16 s (docs/design.md, section 5). A compiler
# takes a precompiled header only with the options that it was made with, so there is one for each
# kind of target, made by a library of one empty source.
option(ENGRAM_PRECOMPILED "Parse common headers once for all sources of a kind" ON)

# engram_precompiled_kind(network LINK engram_protocol)
#
# Makes cmake/precompiled/<kind>.h ready for engram_precompiled(). PROGRAM: for sources of
# executables, which are compiled without -fPIC. HIDDEN: for modules, whose symbols are hidden.
function(engram_precompiled_kind kind)
  if(NOT ENGRAM_PRECOMPILED)
    return()
  endif()
  cmake_parse_arguments(ARG "PROGRAM;HIDDEN" "" "LINK" ${ARGN})
  set(source ${PROJECT_BINARY_DIR}/precompiled/${kind}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Carries a precompiled header.\n")
  set(target engram_precompiled_${kind})
  add_library(${target} OBJECT EXCLUDE_FROM_ALL ${source})
  if(NOT ARG_PROGRAM)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  if(ARG_HIDDEN)
    set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden)
  endif()
  target_link_libraries(${target} PRIVATE engram_options fmt::fmt nlohmann_json::nlohmann_json ${ARG_LINK})
  # By name and not by path: ccache then finds in one checkout what it compiled in another.
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/precompiled)
  target_precompile_headers(${target} PRIVATE <${kind}.h>)
endfunction()

# engram_precompiled(engram_wire network)
#
# The sources of a target see cmake/precompiled/<kind>.h first.
function(engram_precompiled target kind)
  if(NOT ENGRAM_PRECOMPILED)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM engram_precompiled_${kind})
  # GCC forgets which warnings a header turned off for itself once that header is precompiled:
  # these three are what <bits/char_traits.h> turns off.
  target_compile_options(${target} PRIVATE
    "$<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-array-bounds>>")
endfunction()
