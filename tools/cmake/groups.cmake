# Sources are compiled in groups: a clean build takes less than half the time. -DCMAKE_UNITY_BUILD=OFF, a variable of CMake, compiles every source
# alone, where it has to name what it needs (tools/check/alone).
set(cvtflow_groups ON)
if(DEFINED CMAKE_UNITY_BUILD AND NOT CMAKE_UNITY_BUILD)
  set(cvtflow_groups OFF)
endif()
# Headers that most units of a target read, compiled once. Not with a compiler cache, which would have to keep them with every unit.
set(CVTFLOW_PRECOMPILE ${cvtflow_groups})
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
  set(CVTFLOW_PRECOMPILE OFF)
endif()

# Compiles a target's sources in groups of neighbours, which therefore share one space of local names: half of the time of a group of five
# goes into reading headers and making what templates need. With "eigen", those that include Eigen form separate groups: reading it and
# compiling its decompositions takes longer than they do. Sources with further definitions stay by themselves.
function(cvtflow_in_groups target)
  if(NOT cvtflow_groups)
    return()
  endif()
  set(most_in_group 32)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL EXECUTABLE)   # command line and tests: more headers than code
    set(most_in_group 32)
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  set(plain "")
  set(eigen "")
  foreach(source ${sources})
    file(STRINGS ${source} includes_eigen REGEX "^#include <Eigen/" LIMIT_COUNT 1)
    if(includes_eigen AND "eigen" IN_LIST ARGN)
      list(APPEND eigen ${source})
    else()
      list(APPEND plain ${source})
    endif()
  endforeach()
  foreach(kind plain eigen)
    list(LENGTH ${kind} count)
    math(EXPR groups "(${count} + ${most_in_group} - 1) / ${most_in_group}")
    set(number 0)
    foreach(source ${${kind}})
      math(EXPR group "${number} * ${groups} / ${count}")   # of equal size
      math(EXPR number "${number} + 1")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${target}_${kind}_${group})
    endforeach()
  endforeach()
endfunction()
