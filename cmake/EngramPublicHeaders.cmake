# SPDX-License-Identifier: Apache-2.0

# Which headers are a promise: these, and what they include. Programs that use Engram see no others;
# all the rest is installed by the component `internals` alone, and changes as it must
# (docs/cpp_api.md). tests/consumer holds an installation to this list.
set(ENGRAM_PUBLIC_ROOTS
  # The front door, and servers by name.
  memory/memory.h
  memory/replay_control.h
  server/client/memory_client.h
  # What generated code includes (ltm/idf/generate_cpp.cpp).
  ltm/typed/convert.h
  ltm/typed/convert_eigen.h
  ltm/typed/defaults.h
  ltm/typed/image.h
  ltm/typed/point_cloud.h
  ltm/typed/pose.h)

# engram_find_public_headers(headers)
#
# Follows the includes from the roots. Each header that was read is watched: who adds an include to
# one of them has the list made anew by the next build.
function(engram_find_public_headers result)
  set(found)
  set(waiting ${ENGRAM_PUBLIC_ROOTS})
  while(waiting)
    list(POP_FRONT waiting header)
    if(header IN_LIST found)
      continue()
    endif()
    set(file ${PROJECT_SOURCE_DIR}/${header})
    if(NOT EXISTS ${file})
      message(FATAL_ERROR "The public header ${header} is missing")
    endif()
    list(APPEND found ${header})
    set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(STRINGS ${file} includes REGEX "^[ \t]*#[ \t]*include[ \t]*\"")
    foreach(include IN LISTS includes)
      string(REGEX REPLACE "^[^\"]*\"([^\"]+)\".*" "\\1" include "${include}")
      list(APPEND waiting ${include})
    endforeach()
  endwhile()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

engram_find_public_headers(ENGRAM_PUBLIC_HEADERS)

# engram_add_headers(engram_store a.h b.h)
#
# Gives a room its headers, in two sets: HEADERS are public, `internals` are all others. Both are
# checked, and whoever links the room in this build may include both.
function(engram_add_headers target)
  set(public)
  set(internal)
  foreach(header IN LISTS ARGN)
    file(RELATIVE_PATH path ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/${header})
    if(path IN_LIST ENGRAM_PUBLIC_HEADERS)
      list(APPEND public ${header})
    else()
      list(APPEND internal ${header})
    endif()
  endforeach()
  target_sources(${target} PUBLIC
    FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${public}
    FILE_SET internals TYPE HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${internal})
  set_target_properties(${target} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
  install(TARGETS ${target} EXPORT engram
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/engram
          FILE_SET internals DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/engram
                             COMPONENT internals EXCLUDE_FROM_ALL)
endfunction()
