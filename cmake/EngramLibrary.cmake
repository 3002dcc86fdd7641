# SPDX-License-Identifier: Apache-2.0

# Settings that every target of ours shares.
add_library(engram_options INTERFACE)
target_compile_features(engram_options INTERFACE cxx_std_20)
# Some of what we link asks for -pthread, and a precompiled header is for all or none.
target_compile_options(engram_options INTERFACE $<BUILD_INTERFACE:-pthread>)
# GCC 12 takes moved-from variants for uninitialised ones, joined strings for overlapping ones, and
# empty ones for null pointers.
target_compile_options(engram_options INTERFACE
  $<BUILD_INTERFACE:-Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
                    -Wcast-align -Wunused -Wnull-dereference -Wno-missing-field-initializers>
  "$<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-restrict;-Wno-null-dereference>>")
# Sources that are compiled together look like one header to GCC, where no type may have a member
# whose type only one source knows.
target_compile_options(engram_options INTERFACE
  "$<BUILD_INTERFACE:$<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wno-subobject-linkage>>")
# GCC looks for garbage each time its heap grew by a third. Sources that are compiled together need up
# to 1.5 GB, and a compiler that waits until then takes 15 % less time and 0.3 GB more.
target_compile_options(engram_options INTERFACE
  "$<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1048576>>")
install(TARGETS engram_options EXPORT engram)

# engram_add_library(store SOURCES a.cpp HEADERS a.h PUBLIC engram::codec PRIVATE hdf5)
#
# Declares one room as engram::<name>. Paths are relative to the room; headers are included from
# the repository root and must each compile alone (target all_verify_interface_header_sets); the
# public ones install under include/engram/, the rest with the component `internals`
# (cmake/EngramPublicHeaders.cmake). PRECOMPILED names what its sources see first
# (cmake/EngramPrecompiled.cmake): standard where nothing is said; none where the room has its own.
function(engram_add_library name)
  cmake_parse_arguments(ARG "" "PRECOMPILED" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "engram_add_library(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  set(target engram_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(engram::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  engram_add_headers(${target} ${ARG_HEADERS})
  target_link_libraries(${target} PUBLIC engram_options ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  if(NOT ARG_PRECOMPILED)
    set(ARG_PRECOMPILED standard)
  endif()
  if(NOT ARG_PRECOMPILED STREQUAL none)
    engram_precompiled(${target} ${ARG_PRECOMPILED})
  endif()
endfunction()

# engram_add_room_types(skills skill_types.xml)
#
# C++ for the types of a room, from IDF files beside its sources. Headers of the room may include
# what is generated, which is therefore installed where they are: with the component `internals`.
function(engram_add_room_types name)
  engram_add_idf_types(engram_${name} ROOT ${PROJECT_SOURCE_DIR} FILES ${ARGN})
  file(RELATIVE_PATH room ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  foreach(xml IN LISTS ARGN)
    cmake_path(GET xml STEM LAST_ONLY stem)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/engram_${name}_idf_types/${room}/${stem}.h
            DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/engram/${room}
            COMPONENT internals EXCLUDE_FROM_ALL)
  endforeach()
endfunction()

# engram_cold(engram_measure [HOT similarity.cpp])
#
# A room where no program spends its time, but for its HOT sources: release builds optimise it with
# -O1 and not with -O3. Whoever calls this says there why nothing in it is hot; loops over pixels,
# numbers or snapshots belong elsewhere. -O1 and not -Os, because a precompiled header is for both or
# for neither. A room whose sources are hot in part is two libraries, so that each is compiled
# together.
function(engram_cold target)
  cmake_parse_arguments(ARG "" "" "HOT" ${ARGN})
  target_compile_options(${target} PRIVATE "$<BUILD_INTERFACE:$<$<CONFIG:Release>:-O1>>")
  set_property(SOURCE ${ARG_HOT} APPEND PROPERTY COMPILE_OPTIONS "$<$<CONFIG:Release>:-O3>")
endfunction()
