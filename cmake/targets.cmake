# The compile options everything shares, and one function per kind of target.

# A target whose property TEMPOLUX_COLD is true holds no loops that take time: it is optimised less, which halves what it takes to compile.
add_library(tempolux_options INTERFACE)
target_include_directories(tempolux_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(tempolux_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>   # false alarms of GCC 12 on std::string (bug 105651)
  -Winvalid-pch
  -ffp-contract=off            # the same bits on every machine of one instruction set
  -fno-math-errno -fno-trapping-math
  $<IF:$<BOOL:${TEMPOLUX_NATIVE}>,-march=native,-march=x86-64-v3>
  $<$<CONFIG:Release>:$<IF:$<BOOL:$<TARGET_PROPERTY:TEMPOLUX_COLD>>,-O1,-O3>>)
target_compile_definitions(tempolux_options INTERFACE TEMPOLUX_VERSION="${PROJECT_VERSION}")
if(TEMPOLUX_SANITIZE)
  target_compile_options(tempolux_options INTERFACE -fsanitize=${TEMPOLUX_SANITIZE}
    -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(tempolux_options INTERFACE -fsanitize=${TEMPOLUX_SANITIZE})
endif()
if(TEMPOLUX_FUZZ)
  target_compile_options(tempolux_options INTERFACE -fsanitize=fuzzer-no-link)
endif()
set(CMAKE_EXE_LINKER_FLAGS "${CMAKE_EXE_LINKER_FLAGS} -Wl,--as-needed")

# tempolux_library(NAME DEPENDS lib... PRIVATE lib...): all .cpp of this folder's NAME/ as library tempolux_NAME.
function(tempolux_library name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(sources)
    add_library(tempolux_${name} STATIC ${sources})
    set_target_properties(tempolux_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(tempolux_${name} PUBLIC tempolux_options ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE})
  else()
    add_library(tempolux_${name} INTERFACE)
    target_link_libraries(tempolux_${name} INTERFACE tempolux_options ${ARG_DEPENDS})
  endif()
endfunction()

# tempolux_tool(NAME DEPENDS lib...): NAME.cpp is the program NAME.
function(tempolux_tool name)
  cmake_parse_arguments(ARG "" "" "DEPENDS" ${ARGN})
  if(NOT EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${name}.cpp)
    message(FATAL_ERROR "tempolux_tool(${name}): no ${name}.cpp")
  endif()
  add_executable(${name} ${name}.cpp)
  target_link_libraries(${name} PRIVATE tempolux_options tempolux_tool_main ${ARG_DEPENDS})
  target_precompile_headers(${name} REUSE_FROM tempolux_tool_main)
  set_target_properties(${name} PROPERTIES TEMPOLUX_COLD ON RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  add_dependencies(${name} tempolux-images tempolux-decode)   # opened when a scene has images, started when it is packed
  if(name STREQUAL "aqm-compare")
    add_dependencies(${name} tempolux-fourier)   # opened by the model of vision
  endif()
  set_property(GLOBAL APPEND PROPERTY TEMPOLUX_TOOLS ${name})
endfunction()

# tempolux_test(SOURCE DEPENDS lib...): a GoogleTest program; one CTest per program.
function(tempolux_test source)
  cmake_parse_arguments(ARG "" "TIMEOUT" "DEPENDS" ${ARGN})
  get_filename_component(name ${source} NAME_WE)
  get_filename_component(folder ${source} DIRECTORY)
  string(REPLACE "/" "." test ${folder}.${name})
  add_executable(${name} ${source})
  # -O1 compiles a test in three quarters of the time. Slow tests run as fast as with -O3.
  set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS $<$<CONFIG:Release>:-O1>)
  target_link_libraries(${name} PRIVATE tempolux_options ${ARG_DEPENDS} GTest::gtest_main)
  # gtest and sign conversions inside test literals: noise, not findings
  target_compile_options(${name} PRIVATE -Wno-conversion -Wno-sign-conversion)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  add_dependencies(${name} tempolux-images tempolux-decode)
  add_test(NAME ${test} COMMAND ${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}/tests)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(TEMPOLUX_SANITIZE)  # ten times slower, at a load that need not be low
    math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 5")
  endif()
  set_tests_properties(${test} PROPERTIES TIMEOUT ${ARG_TIMEOUT} SKIP_REGULAR_EXPRESSION "skipped: all")
endfunction()
