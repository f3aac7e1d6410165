# Read by ctest before it runs: a test for each suite of `program`, so that its cases share what starting costs (a hundred libraries of
# VTK to load, a driver of OpenGL and its shaders to compile). `alone`: suites whose cases run in processes of their own.
execute_process(COMMAND "${program}" --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failure)
if(failure)
  add_test(cellproj_tests "${program}" --gtest_list_tests)  # fails, and says why
  return()
endif()

function(add_cases name filter)
  add_test("${name}" "${program}" "--gtest_filter=${filter}")
  # A suite that went well but skipped a case is shown as skipped: skipped is not passed. One that hangs is ended.
  set_tests_properties("${name}" PROPERTIES TIMEOUT 600 ENVIRONMENT "${environment}"
    SKIP_REGULAR_EXPRESSION "\\[  PASSED  \\] [0-9]+ tests?\\.\n(\\[  SKIPPED \\][^\n]*\n)+$")
endfunction()

string(REGEX REPLACE " *#[^\n]*" "" listed "${listed}")  # the values of parameters
string(REPLACE "\n" ";" lines "${listed}")
foreach(line IN LISTS lines)
  string(STRIP "${line}" name)
  if(NOT line MATCHES "^ ")  # "Suite."
    string(REGEX REPLACE "\\.$" "" suite "${name}")
    set(is_new TRUE)
  elseif(suite MATCHES "^(${alone})$")
    add_cases("${suite}.${name}" "${suite}.${name}")
  elseif(is_new)
    add_cases("${suite}" "${suite}.*")
    set(is_new FALSE)
  endif()
endforeach()
