# Writes the tests of a program for ctest, one for each suite:
#   cmake -D PROGRAM=file -D LABEL=label -D SECONDS=limit -D OUT=file -P suites.cmake
# A suite, or the prefix of one with parameters, that begins with Deep or Nightly has that label; Extremes gives the label extremes. Nightly tests are
# long, so each is one of ctest.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${failed}")
endif()
string(REGEX REPLACE "[][;]" "_" listed "${listed}")   # values of parameters, in comments
string(REPLACE "\n" ";" lines "${listed}")
set(suite "")
set(suites "")
foreach(line ${lines})
  if(line MATCHES "^([^ ]+)\\.")
    set(suite "${CMAKE_MATCH_1}")
    set(count_${suite} 0)
  elseif(NOT line MATCHES "^  DISABLED_" AND line MATCHES "^  ([^ ]+)")   # the last condition sets CMAKE_MATCH_1
    if(CMAKE_MATCH_1 STREQUAL "")
      message(FATAL_ERROR "a case of ${suite} without its name would run no test: ${line}")
    endif()
    set(case "${suite}.${CMAKE_MATCH_1}")
    if(suite MATCHES "(^|/)Nightly")
      list(APPEND nightly "${case}")
    elseif(count_${suite} EQUAL 0)
      list(APPEND suites "${suite}")
    endif()
    math(EXPR count_${suite} "${count_${suite}} + 1")
  endif()
endforeach()

set(text "")
# add(name filter labels limit cost). GNU's OpenMP never yields unless told so: two threads on one processor then need 8 ms per barrier.
function(add name filter labels limit cost)
  string(APPEND text "add_test([==[${name}]==] [==[${PROGRAM}]==] [==[--gtest_filter=${filter}]==])\n"
    "set_tests_properties([==[${name}]==] PROPERTIES LABELS [==[${labels}]==] TIMEOUT ${limit} COST ${cost} ENVIRONMENT OMP_WAIT_POLICY=passive\n"
    "  FAIL_REGULAR_EXPRESSION [==[Running 0 tests]==])\n")
  set(text "${text}" PARENT_SCOPE)
endfunction()
foreach(suite ${suites})
  set(labels ${LABEL})
  if(suite MATCHES "(^|/)Extremes")
    set(labels extremes)
  elseif(suite MATCHES "(^|/)Deep")
    set(labels ${LABEL} deep)
  endif()
  add("${suite}" "${suite}.*" "${labels}" ${SECONDS} ${count_${suite}})
endforeach()
foreach(case ${nightly})
  add("${case}.nightly" "${case}" nightly 4800 1)
endforeach()
file(WRITE ${OUT} "${text}")
