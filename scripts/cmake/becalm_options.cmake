# Compiler settings shared by every target, as an interface library that each target links.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

set(BECALM_SANITIZE "" CACHE STRING "Sanitizers to build with, as -fsanitize= takes them")

add_library(becalm_options INTERFACE)
target_compile_options(becalm_options INTERFACE -Wall -Wextra)
option(BECALM_WERROR "Warnings are errors: for development, with the compiler that the tests run with" OFF)
if(BECALM_WERROR)
  target_compile_options(becalm_options INTERFACE -Werror)
endif()
# x86-64-v2 includes SSE4.2, which every processor has that Embree runs well on. With -ffp-contract=off results do not depend on
# whether the instruction set has fused multiply-add.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(becalm_options INTERFACE -march=x86-64-v2)
endif()
target_compile_options(becalm_options INTERFACE -ffp-contract=off)
# Nothing reads the errno of mathematical functions, or floating-point flags; with neither to keep, roots take one instruction, and
# loops over pixels, corners and choices vectorise. Values do not change.
target_compile_options(becalm_options INTERFACE -fno-math-errno -fno-trapping-math)
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
  # The debug preset runs all unit tests; -Og makes them faster and still lets a debugger step through them.
  target_compile_options(becalm_options INTERFACE -Og)
endif()
# Without NDEBUG the release build keeps its assertions, which are cheap.
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # At -O3 these warnings are false for the inlined operator+ of std::string (GCC bug 105651) and for fmt's parser.
  target_compile_options(becalm_options INTERFACE -Wno-restrict -Wno-stringop-overflow)
endif()
# Sources are compiled in batches, since the headers and templates of the same few libraries take most of their time. Each source
# still includes what it uses; -DCMAKE_UNITY_BUILD=OFF compiles each by itself.
set(CMAKE_UNITY_BUILD ON CACHE BOOL "Compile the sources of the libraries and of becalm in batches")
set(CMAKE_UNITY_BUILD_BATCH_SIZE 18)
# becalm_batches(TARGET GROUPED...): the target's sources but those GROUPED, whose UNITY_GROUP is set, in batches of that size.
function(becalm_batches target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS ARGN)
    if(NOT source IN_LIST sources)
      message(FATAL_ERROR "${target}: ${source}: no source of this target")
    endif()
  endforeach()
  list(REMOVE_ITEM sources ${ARGN})
  set(number 0)
  foreach(source IN LISTS sources)
    math(EXPR batch "${number} / ${CMAKE_UNITY_BUILD_BATCH_SIZE}")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${batch})
    math(EXPR number "${number} + 1")
  endforeach()
endfunction()
if(BECALM_SANITIZE)
  target_compile_options(becalm_options INTERFACE -fsanitize=${BECALM_SANITIZE} -fno-sanitize-recover=all
                                                  -fno-omit-frame-pointer)
  target_link_options(becalm_options INTERFACE -fsanitize=${BECALM_SANITIZE})
  # Reports need functions and lines only; debug information of variables would take a quarter of the compile time.
  set(CMAKE_CXX_FLAGS_DEBUG "-g1")
endif()
if(BECALM_SANITIZE MATCHES thread)
  # Its tbb/parallel_for.h replaces oneTBB's.
  target_include_directories(becalm_options BEFORE INTERFACE ${PROJECT_SOURCE_DIR}/tests/thread_sanitizer)
endif()
if(BECALM_FUZZ)
  # Every object counts its branches for libFuzzer, whose main() only the fuzz targets link. Clang's additional warnings are no errors.
  target_compile_options(becalm_options INTERFACE -fsanitize=fuzzer-no-link -Wno-error)
endif()
