# One place for what every target of the project shares.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Programs and libraries where the front door and the tests find them; installed programs find theirs beside them.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_INSTALL_RPATH $ORIGIN/../${CMAKE_INSTALL_LIBDIR})

add_library(embacle_options INTERFACE)
target_compile_features(embacle_options INTERFACE cxx_std_20)
target_compile_options(embacle_options INTERFACE
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # false positives of GCC 12 in std::string
  # and in the AVX-512 intrinsics that Eigen uses on processors that have them (GCC bug 105593)
  "$<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-uninitialized;-Wno-maybe-uninitialized>"
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wcast-align -Woverloaded-virtual
  $<$<BOOL:${EMBACLE_WERROR}>:-Werror>
  $<$<BOOL:${EMBACLE_NATIVE}>:-march=native>
  $<$<CONFIG:Release>:-O3 -fno-math-errno -fno-trapping-math>
  $<$<BOOL:$<TARGET_PROPERTY:EMBACLE_TEST>>:-O1>)  # GoogleTest's macros take long; what they test is in the libraries
if(EMBACLE_SANITIZE)
  target_compile_options(embacle_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(embacle_options INTERFACE -fsanitize=address,undefined)
endif()

# Headers that most sources read and that take most of the compile time. A precompiled set serves one target, or all tests
# of a directory; every source still includes what it uses: clang-tidy reads the sources without the sets.
option(EMBACLE_PRECOMPILE "Precompile common headers" ON)
function(embacle_precompile target)
  if(EMBACLE_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE
      <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <optional> <span> <sstream>
      <string> <utility> <vector> <mpi.h> <fmt/format.h> <Eigen/Dense> ${ARGN})
  endif()
endfunction()

# embacle_test(NAME SOURCES... [RANKS 1 2 4] [LIBRARIES ...]): a GoogleTest program, run on each of the rank counts.
# All carry the label `unit` (./embacle test -L unit).
# Programs with RANKS have their own main that initialises MPI: link embacle_test_main_mpi (coupling/tests).
function(embacle_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;RANKS;LIBRARIES" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES EMBACLE_TEST ON)
  target_link_libraries(${name} PRIVATE embacle_options GTest::gtest ${ARG_LIBRARIES})
  get_property(owner DIRECTORY PROPERTY EMBACLE_PRECOMPILED_TEST)
  if(owner AND EMBACLE_PRECOMPILE)
    target_precompile_headers(${name} REUSE_FROM ${owner})
  else()
    embacle_precompile(${name} <gtest/gtest.h>)
    set_property(DIRECTORY PROPERTY EMBACLE_PRECOMPILED_TEST ${name})
  endif()
  if(ARG_RANKS)
    target_link_libraries(${name} PRIVATE embacle_test_main_mpi)
    foreach(ranks ${ARG_RANKS})
      add_test(NAME ${name}.${ranks} COMMAND ${MPIEXEC_EXECUTABLE} --oversubscribe --mca mpi_yield_when_idle 1
        --mca btl_vader_single_copy_mechanism none -n ${ranks} $<TARGET_FILE:${name}>)
      set_tests_properties(${name}.${ranks} PROPERTIES TIMEOUT ${ARG_TIMEOUT} PROCESSORS ${ranks} LABELS unit
        ENVIRONMENT "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_rmaps_base_oversubscribe=1")
    endforeach()
  else()
    target_link_libraries(${name} PRIVATE GTest::gtest_main)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS unit)
  endif()
endfunction()
