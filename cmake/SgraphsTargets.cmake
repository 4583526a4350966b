# The one place where compile options live. Every target is made by sgraphs_library, sgraphs_executable or
# sgraphs_test, so that language level, warnings, floating-point rules and sanitizers are the same everywhere.

set(SGRAPHS_SANITIZER "" CACHE STRING "address (with undefined behaviour), thread, or empty")
set_property(CACHE SGRAPHS_SANITIZER PROPERTY STRINGS "" address thread)

# Headers that most sources include (Eigen alone costs a second of each), read once for the libraries and once for the
# tests, where Eigen is set up differently. Without CMAKE_DISABLE_PRECOMPILE_HEADERS a forgotten #include of one of
# them goes unnoticed; tools/lint builds without.
set(SGRAPHS_COMMON_HEADERS <algorithm> <array> <cmath> <cstdint> <functional> <map> <memory> <optional> <set> <span>
  <sstream> <stdexcept> <string> <string_view> <utility> <vector> <Eigen/Core> <Eigen/Geometry>
  ${PROJECT_SOURCE_DIR}/common/geometry/decompositions.h)
set(SGRAPHS_TEST_HEADERS <gmock/gmock.h> <gtest/gtest.h>)

# sgraphs_precompiled(NAME HEADERS…): a target whose precompiled headers others use.
function(sgraphs_precompiled name)
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp.new "// Nothing: this target is its precompiled headers.\n")
  configure_file(${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp.new ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp COPYONLY)
  add_library(${name} STATIC ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  sgraphs_target_defaults(${name})
  target_link_libraries(${name} PRIVATE Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

function(sgraphs_target_defaults target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  # Headers are included by their path from the top: "common/geometry/se3.h".
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR})
  # Same bytes on every replay: no contraction into fused multiply-adds, no reassociation, and the baseline
  # instruction set (-march=native would also break the binary interface with Debian's PCL).
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
    -Woverloaded-virtual -Werror -ffp-contract=off)
  # GCC 12 at -O3 reports "literal" + std::string as overlapping or boundless memory (its bug 105651, mended in 13).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE
      "$<$<CONFIG:Release>:-Wno-restrict;-Wno-stringop-overflow;-Wno-stringop-overread;-Wno-array-bounds>")
  endif()
  if(SGRAPHS_SANITIZER STREQUAL "address")
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-sanitize-recover=all
      -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
    # Debian's Ceres was built where Eigen takes malloc() as it is. Under this sanitizer Eigen would align by hand, and
    # memory taken on one side of the library's border could not be given back on the other.
    target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  elseif(SGRAPHS_SANITIZER STREQUAL "thread")
    target_compile_options(${target} PRIVATE -fsanitize=thread -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=thread)
  elseif(SGRAPHS_SANITIZER)
    message(FATAL_ERROR "SGRAPHS_SANITIZER='${SGRAPHS_SANITIZER}': use address, thread, or nothing")
  endif()
endfunction()

# sgraphs_library(NAME SOURCES a.cpp … [DEPS public libraries] [PRIVATE_DEPS libraries kept out of the headers]
#   [OWN_FLAGS]). Here and below, OWN_FLAGS: a library it uses brings flags (-fPIC, -pthread) that the
#   precompiled headers do not have.
function(sgraphs_library name)
  cmake_parse_arguments(ARG "OWN_FLAGS" "" "SOURCES;DEPS;PRIVATE_DEPS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  sgraphs_target_defaults(${name})
  if(NOT ARG_OWN_FLAGS)
    target_precompile_headers(${name} REUSE_FROM sgraphs_precompiled_headers)
  endif()
  target_link_libraries(${name} PUBLIC ${ARG_DEPS} PRIVATE ${ARG_PRIVATE_DEPS})
endfunction()

# sgraphs_executable(NAME SOURCES main.cpp … DEPS libraries [OUTPUT file name] [OWN_FLAGS]); all programs
# land in build/bin.
function(sgraphs_executable name)
  cmake_parse_arguments(ARG "OWN_FLAGS" "OUTPUT" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  sgraphs_target_defaults(${name})
  if(NOT ARG_OWN_FLAGS)
    target_precompile_headers(${name} REUSE_FROM sgraphs_precompiled_headers)
  endif()
  target_link_libraries(${name} PRIVATE ${ARG_DEPS})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  if(ARG_OUTPUT)
    set_target_properties(${name} PROPERTIES OUTPUT_NAME ${ARG_OUTPUT})
  endif()
endfunction()

# Uninitialised Eigen values become NaN in tests, so that reading one is seen.
set(SGRAPHS_TEST_DEFINITIONS EIGEN_INITIALIZE_MATRICES_BY_NAN)

# sgraphs_test(NAME SOURCES x_test.cpp … DEPS libraries [SERIAL] [OWN_FLAGS]): one GoogleTest program, its
# cases known to CTest; SERIAL cases run while no other test does.
function(sgraphs_test name)
  cmake_parse_arguments(ARG "SERIAL;OWN_FLAGS" "" "SOURCES;DEPS;LABELS" ${ARGN})
  if(NOT SGRAPHS_BUILD_TESTS)
    return()
  endif()
  add_executable(${name} ${ARG_SOURCES})
  sgraphs_target_defaults(${name})
  if(NOT ARG_OWN_FLAGS)
    target_precompile_headers(${name} REUSE_FROM sgraphs_precompiled_test_headers)
  endif()
  target_compile_definitions(${name} PRIVATE ${SGRAPHS_TEST_DEFINITIONS}
    SGRAPHS_TEST_DATA_DIR="${PROJECT_SOURCE_DIR}/tests/data"
    SGRAPHS_SHARED_DATA_DIR="${PROJECT_SOURCE_DIR}/../shared/data"
    SGRAPHS_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    SGRAPHS_BINARY_DIR="${PROJECT_BINARY_DIR}/bin")
  target_link_libraries(${name} PRIVATE ${ARG_DEPS} GTest::gtest GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  # Named only where they have a value: an empty one would swallow the next word.
  set(properties TIMEOUT 600 RUN_SERIAL ${ARG_SERIAL})
  if(ARG_LABELS)
    list(APPEND properties LABELS ${ARG_LABELS})
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES ${properties})
endfunction()

sgraphs_precompiled(sgraphs_precompiled_headers ${SGRAPHS_COMMON_HEADERS})
if(SGRAPHS_BUILD_TESTS)
  find_package(GTest REQUIRED)
  sgraphs_precompiled(sgraphs_precompiled_test_headers ${SGRAPHS_COMMON_HEADERS} ${SGRAPHS_TEST_HEADERS})
  target_compile_definitions(sgraphs_precompiled_test_headers PRIVATE ${SGRAPHS_TEST_DEFINITIONS})
  target_link_libraries(sgraphs_precompiled_test_headers PRIVATE GTest::gtest GTest::gmock)
endif()
