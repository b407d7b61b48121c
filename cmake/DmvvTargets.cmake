# How every library of the project is set up: dmvv_library(name SOURCES... ) makes target dmvv_<name>, alias dmvv::<name>.

add_library(dmvv_warnings INTERFACE)
target_compile_options(dmvv_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow $<$<BOOL:${DMVV_WERROR}>:-Werror>)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(dmvv_warnings INTERFACE -Wno-restrict)  # false alarms on std::string: GCC bug 105329
endif()
add_library(dmvv_sanitize INTERFACE)
if(DMVV_SANITIZE)
  # Without vptr: Debian's glslang is built without RTTI.
  target_compile_options(dmvv_sanitize INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
    -fno-sanitize=vptr -fno-omit-frame-pointer)
  # RPATH, not RUNPATH: modules are opened through the sanitizer's own dlopen, for which the program's RUNPATH does not count.
  target_link_options(dmvv_sanitize INTERFACE -fsanitize=address,undefined -Wl,--disable-new-dtags)
  target_sources(dmvv_sanitize INTERFACE
    $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${PROJECT_SOURCE_DIR}/cmake/keep_modules.cpp>)
  if(DMVV_FUZZ)
    target_compile_options(dmvv_sanitize INTERFACE -fsanitize=fuzzer-no-link)
  endif()
endif()

function(dmvv_library name)
  add_library(dmvv_${name} STATIC ${ARGN})
  add_library(dmvv::${name} ALIAS dmvv_${name})
  set_target_properties(dmvv_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(dmvv_${name} PUBLIC cxx_std_20)
  target_include_directories(dmvv_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/dmvv>)
  target_link_libraries(dmvv_${name} PRIVATE $<BUILD_INTERFACE:dmvv_warnings> $<BUILD_INTERFACE:dmvv_sanitize>)
endfunction()

# dmvv_test(name LABEL [OWN_MAIN] SOURCES... LIBS libs): a doctest executable registered with CTest as `name`.
function(dmvv_test name)
  cmake_parse_arguments(ARG "OWN_MAIN" "LABEL" "SOURCES;LIBS" ${ARGN})
  if(NOT ARG_OWN_MAIN)
    list(APPEND ARG_SOURCES ${PROJECT_SOURCE_DIR}/tests/doctest_main.cpp)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} doctest::doctest dmvv_warnings dmvv_sanitize)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_compile_definitions(${name} PRIVATE
    DMVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}" DMVV_BINARY_DIR="${CMAKE_BINARY_DIR}")
  add_test(NAME ${name} COMMAND ${name} --no-intro)
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABEL}")
endfunction()

# dmvv_data_absent(TEST WHAT): stands for a test whose data is not there: shown as skipped, never as passed.
function(dmvv_data_absent test what)
  message(STATUS "data absent: ${what}")
  add_test(NAME ${test}_data_absent COMMAND ${CMAKE_COMMAND} -E echo "data absent: ${what}")
  set_tests_properties(${test}_data_absent PROPERTIES SKIP_REGULAR_EXPRESSION "data absent")
endfunction()

# SwiftShader, a second implementation of Vulkan with other limits (Debian: chromium-common; scripts/setup --swiftshader).
find_file(DMVV_SWIFTSHADER vk_swiftshader_icd.json PATHS /usr/lib/chromium NO_DEFAULT_PATH)

# dmvv_swiftshader_test(TEST COMMAND...): the command on SwiftShader, where it is there, registered as swiftshader_TEST.
function(dmvv_swiftshader_test test)
  if(DMVV_SWIFTSHADER)
    add_test(NAME swiftshader_${test} COMMAND ${ARGN})
    set_tests_properties(swiftshader_${test} PROPERTIES LABELS swiftshader
      ENVIRONMENT "VK_DRIVER_FILES=${DMVV_SWIFTSHADER};VK_ICD_FILENAMES=${DMVV_SWIFTSHADER}")
  endif()
endfunction()
