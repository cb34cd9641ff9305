include(GoogleTest)

# Build only what the tests of these labels need: "threads" the thread sanitizer's, "numbers" clang++
# Release's, "engine" those that CI runs with the address sanitizer. A room whose results depend on how a
# compiler computes sets SF_ROOM_LABELS to numbers.
add_custom_target(fast_tests)
add_custom_target(threads_tests)
add_custom_target(numbers_tests)
add_custom_target(engine_tests)

# Half of what a test's source costs to compile is gtest.h: the fast tests share it, compiled once.
if(SF_BUILD_TESTS)
  find_package(GTest REQUIRED)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/test_headers.cpp CONTENT "// The headers alone.\n")
  add_library(sf_test_headers OBJECT ${CMAKE_BINARY_DIR}/test_headers.cpp)
  target_link_libraries(sf_test_headers PRIVATE sf_options GTest::gtest)
  target_compile_options(sf_test_headers PRIVATE -O0)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    # Else ccache finds nothing again: no two compilations have the same time in them.
    target_compile_options(sf_test_headers PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
  target_precompile_headers(sf_test_headers PRIVATE <gtest/gtest.h> <algorithm> <array> <cmath>
                            <vector>)
endif()

# A test that opens a window runs behind ${SF_DISPLAY}: a display of its own, which stays as it is when
# its last window closes (without -noreset it starts anew and refuses the next window for a moment).
if(SF_BUILD_TESTS)
  find_program(XVFB_RUN xvfb-run REQUIRED)
  set(SF_DISPLAY ${XVFB_RUN} -a -s "-screen 0 1280x720x24 -noreset")
endif()

# sf_test(NAME SOURCES... LIBS... [LABELS fast [threads]|slow [display]] [TIMEOUT s] [SHARDS n]):
# one GoogleTest program, each of its tests known to ctest; with the address sanitizer, whose programs
# are slow to start, the program alone, or so many equal parts of it, which are begun first. Label "fast"
# (the default) means: it also runs under the address sanitizer, with "threads" under the thread sanitizer
# too, which has nothing to look at in a program of one thread. Tests labelled "slow" are begun first, so
# that none runs alone in the end. "display": it opens a window.
function(sf_test name)
  if(NOT SF_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "TIMEOUT;SHARDS" "SOURCES;LIBS;LABELS" ${ARGN})
  if(NOT ARG_LABELS)
    set(ARG_LABELS fast)
  endif()
  if("fast" IN_LIST ARG_LABELS)
    list(APPEND ARG_LABELS ${SF_ROOM_LABELS})
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  set(cost 0)
  if("slow" IN_LIST ARG_LABELS)
    set(cost 1)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE sf_options ${ARG_LIBS} GTest::gtest GTest::gtest_main)
  if("fast" IN_LIST ARG_LABELS)
    # Two thirds of all compiling are the tests' own code, full of macros, which -O0 nearly halves (and
    # more than halves under the sanitizers). What they call is in libraries, which keep their level.
    target_compile_options(${name} PRIVATE -O0)
    target_precompile_headers(${name} REUSE_FROM sf_test_headers)
    add_dependencies(fast_tests ${name})
  endif()
  foreach(label threads numbers engine)
    if(label IN_LIST ARG_LABELS)
      add_dependencies(${label}_tests ${name})
    endif()
  endforeach()
  if(SF_SANITIZE AND NOT "fast" IN_LIST ARG_LABELS)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)  # it runs in Release alone
  endif()
  # gtest_discover_tests takes a list apart, and with it every property after LABELS; joined by "+"
  # the labels stay one word, which `ctest -L fast` finds just as well.
  string(JOIN "+" labels ${ARG_LABELS})
  if(SF_SANITIZE MATCHES "address")
    if(NOT ARG_SHARDS)
      set(ARG_SHARDS 1)
    endif()
    foreach(shard RANGE 1 ${ARG_SHARDS})
      math(EXPR index "${shard} - 1")
      add_test(NAME ${name}_${shard} COMMAND ${name} --gtest_brief=1)
      set_tests_properties(${name}_${shard} PROPERTIES LABELS "${labels}" TIMEOUT 1200
        COST ${ARG_SHARDS}
        ENVIRONMENT "GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${index};GTEST_OUTPUT=xml:${CMAKE_BINARY_DIR}/gtest/${name}_${shard}.xml")
    endforeach()
    return()
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS "${labels}" TIMEOUT
                       ${ARG_TIMEOUT} COST ${cost})
endfunction()

# The fuzz targets are known to ./check by this list: one line "NAME CORPUS" each.
set(SF_FUZZ_LIST ${CMAKE_BINARY_DIR}/fuzz-targets.txt)
if(SF_FUZZ)
  add_custom_target(fuzz_targets)
  file(WRITE ${SF_FUZZ_LIST} "")
endif()

# sf_fuzzed(TARGET [SOURCES...]): a library, or sources of it, that takes in a stranger's bytes: the
# fuzzer is told which ways they go.
function(sf_fuzzed target)
  cmake_parse_arguments(ARG "" "" "SOURCES" ${ARGN})
  if(SF_FUZZ AND ARG_SOURCES)
    set_property(SOURCE ${ARG_SOURCES} APPEND PROPERTY COMPILE_OPTIONS -fsanitize=fuzzer-no-link)
  elseif(SF_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# sf_fuzz(NAME SOURCES... LIBS...): a libFuzzer program; its kept corpus is corpus/NAME beside the
# CMakeLists.txt, or fuzz/corpus/NAME.
function(sf_fuzz name)
  if(NOT SF_FUZZ)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE sf_options ${ARG_LIBS})
  sf_fuzzed(${name})
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
  add_dependencies(fuzz_targets ${name})
  set(corpus ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/corpus/${name})
  if(NOT EXISTS ${corpus})
    set(corpus ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${name})
  endif()
  file(APPEND ${SF_FUZZ_LIST} "${name} ${corpus}\n")
endfunction()

# sf_compile_quickly(SOURCE...): for what runs once a start and costs seconds to compile, such as the
# templates of a command line's parser; called in the folder of the target.
function(sf_compile_quickly)
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS -O0)
endfunction()
