# Compares the sources with what clang-format makes of them. -DSOURCE: the project's folder; -DFORMAT: clang-format.
# Not shaders/: its text is part of what the compiler generates.
execute_process(COMMAND git -C ${SOURCE} ls-files *.h *.cpp OUTPUT_VARIABLE listed OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
if(failed)  # not a checkout
  file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/base/*.h ${SOURCE}/base/*.cpp ${SOURCE}/voml/*.h ${SOURCE}/voml/*.cpp
    ${SOURCE}/compiler/*.h ${SOURCE}/compiler/*.cpp ${SOURCE}/runtime/*.h ${SOURCE}/runtime/*.cpp ${SOURCE}/cli/*.h ${SOURCE}/cli/*.cpp)
else()
  string(REPLACE "\n" ";" files "${listed}")
endif()
list(FILTER files EXCLUDE REGEX "^shaders/")
list(LENGTH files count)
if(count LESS 300)
  message(FATAL_ERROR "only ${count} sources were found")
endif()
execute_process(COMMAND ${FORMAT} --dry-run --Werror ${files} WORKING_DIRECTORY ${SOURCE} RESULT_VARIABLE failed ERROR_VARIABLE messages)
if(failed)
  string(SUBSTRING "${messages}" 0 4000 messages)
  message(FATAL_ERROR "these lines are not as .clang-format lays them out; run: clang-format -i FILE\n${messages}")
endif()
