# SPDX-License-Identifier: Apache-2.0

# engram_add_idf_types(robot FILES types/kitchen.xml types/thing.xml [INCLUDES types]
#                      [ROOT types] [OUTPUT folder])
#
# Generates C++ for type descriptions in XML while `robot` is built, and again whenever one of them
# changes. Adds the sources to `robot`, lets it include their headers ("kitchen.h") and links
# engram::typed. An XML file below ROOT (default: the current folder's) keeps its folder where an
# include names one: with ROOT types, types/kitchen/thing.xml becomes "kitchen/thing.h"; without
# ROOT, headers go by file name alone.
#   INCLUDES  where included XML files are looked for, beside the including one; all of them that
#             are to be compiled stand in FILES too, of this target or one that it links
#   OUTPUT    where the code goes; default: <target>_idf_types in the build folder
function(engram_add_idf_types target)
  cmake_parse_arguments(ARG "" "ROOT;OUTPUT" "FILES;INCLUDES" ${ARGN})
  if(ARG_UNPARSED_ARGUMENTS OR NOT ARG_FILES)
    message(FATAL_ERROR "engram_add_idf_types(${target}): needs FILES, found ${ARGN}")
  endif()
  if(NOT ARG_OUTPUT)
    set(ARG_OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${target}_idf_types)
  endif()
  set(include_options)
  foreach(directory IN LISTS ARG_INCLUDES ARG_ROOT)
    file(REAL_PATH "${directory}" directory BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    list(APPEND include_options -I ${directory})
  endforeach()
  set(xml_files)
  foreach(file IN LISTS ARG_FILES)
    file(REAL_PATH "${file}" xml BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    list(APPEND xml_files ${xml})
  endforeach()
  set(generated)
  foreach(xml IN LISTS xml_files)
    set(directory ${ARG_OUTPUT})
    if(ARG_ROOT)
      file(REAL_PATH "${ARG_ROOT}" root BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
      cmake_path(GET xml PARENT_PATH parent)
      file(RELATIVE_PATH below ${root} ${parent})
      if(below MATCHES "^\\.\\.")
        message(FATAL_ERROR "engram_add_idf_types(${target}): ${xml} is not below ROOT ${root}")
      endif()
      if(below)
        set(directory ${ARG_OUTPUT}/${below})
      endif()
    endif()
    cmake_path(GET xml STEM LAST_ONLY stem)
    set(outputs ${directory}/${stem}.h ${directory}/${stem}.cpp)
    # Any of the files may include any other one. Unchanged files stay as they are, so that nothing
    # is compiled again without need; the stamp tells the build that they are up to date.
    add_custom_command(
      OUTPUT ${directory}/${stem}.stamp
      BYPRODUCTS ${outputs}
      COMMAND engram::idf_tool generate ${xml} ${include_options} --cpp ${directory}
      COMMAND ${CMAKE_COMMAND} -E touch ${directory}/${stem}.stamp
      DEPENDS ${xml_files} engram::idf_tool
      COMMENT "Generating C++ for ${stem}.xml"
      VERBATIM)
    list(APPEND generated ${directory}/${stem}.stamp ${outputs})
  endforeach()
  target_sources(${target} PRIVATE ${generated})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${ARG_OUTPUT}>)
  target_link_libraries(${target} PUBLIC engram::typed)
endfunction()
