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
target_compile_options(becalm_options INTERFACE -Wall -Wextra -Werror)
# x86-64-v2 carries SSE4.2, which every processor that Embree runs well on has; -ffp-contract=off keeps a
# program's results equal whatever instruction set a later build chooses.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(becalm_options INTERFACE -march=x86-64-v2)
endif()
target_compile_options(becalm_options INTERFACE -ffp-contract=off)
if(CMAKE_BUILD_TYPE STREQUAL "Debug")
  # Debug runs the whole unit suite, so it is optimised as far as stepping through it allows.
  target_compile_options(becalm_options INTERFACE -Og)
endif()
# Users get the assertions too: without NDEBUG they stay in the release build, where they are cheap.
set(CMAKE_CXX_FLAGS_RELEASE "-O3")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False warnings once std::string's operator+ (GCC bug 105651) or fmt's parser is inlined at -O3.
  target_compile_options(becalm_options INTERFACE -Wno-restrict -Wno-stringop-overflow)
endif()
# Batches of sources are compiled as one: what most of them cost is the headers and templates of the same few libraries.
# Each source still includes what it uses; -DCMAKE_UNITY_BUILD=OFF compiles each alone.
set(CMAKE_UNITY_BUILD ON CACHE BOOL "Compile the sources of the libraries and of becalm in batches")
set(CMAKE_UNITY_BUILD_BATCH_SIZE 9)
if(BECALM_SANITIZE)
  target_compile_options(becalm_options INTERFACE -fsanitize=${BECALM_SANITIZE} -fno-sanitize-recover=all
                                                  -fno-omit-frame-pointer)
  target_link_options(becalm_options INTERFACE -fsanitize=${BECALM_SANITIZE})
  # Reports name functions and lines; variables, of which they say nothing, are a quarter of the compiler's time.
  set(CMAKE_CXX_FLAGS_DEBUG "-g1")
endif()
if(BECALM_SANITIZE MATCHES thread)
  # In front of oneTBB's own parallel_for.h.
  target_include_directories(becalm_options BEFORE INTERFACE ${PROJECT_SOURCE_DIR}/tests/thread_sanitizer)
endif()
if(BECALM_FUZZ)
  # Every object counts its branches for libFuzzer; only the targets link its main(). Another compiler has other
  # warnings, which are none of a fuzzer's business.
  target_compile_options(becalm_options INTERFACE -fsanitize=fuzzer-no-link -Wno-error)
endif()
