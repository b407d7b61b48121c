# Installs the build, moves the prefix to prove that it relocates, builds the consumer against it and runs its test.
#   cmake -DBUILD=... -DSOURCE=... -DGENERATOR=... -DCXX=... -P run.cmake
set(prefix ${BUILD}/tests/prefix)
set(moved ${BUILD}/tests/prefix-moved)
set(consumer ${BUILD}/tests/consumer-build)
file(REMOVE_RECURSE ${prefix} ${moved} ${consumer})

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
file(RENAME ${prefix} ${moved})
file(GLOB_RECURSE configs ${moved}/*.cmake)
foreach(config IN LISTS configs)
  file(READ ${config} text)
  foreach(path ${prefix} ${SOURCE})
    string(FIND "${text}" "${path}" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${config} names ${path}: it does not relocate")
    endif()
  endforeach()
endforeach()
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/consumer -B ${consumer} -G ${GENERATOR} -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${moved})
run(${CMAKE_COMMAND} --build ${consumer})
run(${consumer}/shader_test)
file(WRITE ${consumer}/ball.voml
  "<MVV><OBJECT name=\"BALL\"><REGION name=\"R.BALL\" type=\"color\" rgb=\"1 0.5 0\"/></OBJECT></MVV>")
run(${moved}/bin/dmvv render ${consumer}/ball.voml -o ${consumer}/ball.png --size 32x18)
