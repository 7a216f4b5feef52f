# becalm_embed_module(TARGET SOURCES... LIBRARIES...): a module TARGET_module of the sources and libraries, which the library
# TARGET of the same folder holds between the symbols TARGET_module and TARGET_module_end, to be loaded when it is needed.
enable_language(ASM)
function(becalm_embed_module target)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  set(module ${target}_module)
  add_library(${module} MODULE ${ARG_SOURCES})
  set_target_properties(${module} PROPERTIES PREFIX "" UNITY_BUILD OFF)
  target_include_directories(${module} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${module} PRIVATE ${ARG_LIBRARIES})
  if(NOT BECALM_FUZZ) # whose counters only an executable has
    target_link_libraries(${module} PRIVATE becalm_options)
  endif()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${module}.S)
  configure_file(${PROJECT_SOURCE_DIR}/scripts/cmake/embedded_module.S.in ${source} @ONLY)
  set_source_files_properties(${source} PROPERTIES
    COMPILE_OPTIONS "-I${CMAKE_CURRENT_BINARY_DIR}"
    OBJECT_DEPENDS ${CMAKE_CURRENT_BINARY_DIR}/${module}.so)
  target_sources(${target} PRIVATE ${source})
endfunction()
