# Flags that every part shares. Warnings are errors in the presets of CI only (CMAKE_COMPILE_WARNING_AS_ERROR): a newer compiler's must not stop
# a user's build. -ffp-contract=off: a fused multiply-add here and not there would make results depend on
# segment borders and instruction sets; results are promised bitwise.
add_library(cvtflow_flags INTERFACE)
target_compile_options(cvtflow_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wno-sign-conversion
  -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(NOT cvtflow_groups)   # every source alone (tools/check/alone); in a group, what one file's functions call their variables would have to differ from all constants of its neighbours
  target_compile_options(cvtflow_flags INTERFACE -Wshadow)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12's AVX-512 intrinsics look uninitialised (bug 105593), and "literal" + std::string looks overlapping (bug 105651).
  target_compile_options(cvtflow_flags INTERFACE -Wno-uninitialized -Wno-maybe-uninitialized -Wno-restrict -Wno-free-nonheap-object)
endif()
if(CVTFLOW_SANITIZE)
  target_compile_options(cvtflow_flags INTERFACE -fsanitize=${CVTFLOW_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(cvtflow_flags INTERFACE -fsanitize=${CVTFLOW_SANITIZE})
  if(CVTFLOW_SANITIZE STREQUAL "thread" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Fences in Boost.Asio, which the thread sanitizer does not follow; and texts put together, which instrumented look as if they overflowed.
    target_compile_options(cvtflow_flags INTERFACE -Wno-tsan -Wno-stringop-overflow)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(cvtflow_flags INTERFACE -Wno-array-bounds)   # instrumented loops over Eigen matrices look as if they left std::array
  endif()
endif()
# Hardening, of everything but the kernels, which read no file and have no buffer of a size that a file names: 0.2 to 1 % more instructions.
if(NOT WIN32 AND NOT EMSCRIPTEN AND NOT CVTFLOW_SANITIZE)
  target_compile_options(cvtflow_flags INTERFACE $<$<NOT:$<BOOL:$<TARGET_PROPERTY:CVTFLOW_KERNELS>>>:-fstack-protector-strong>
    "$<$<CONFIG:Release>:-U_FORTIFY_SOURCE>" "$<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2>")
  target_link_options(cvtflow_flags INTERFACE -Wl,-z,relro,-z,now)
endif()
# No unique symbols, which would keep the shared library loaded after dlclose.
target_compile_options(cvtflow_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)
target_include_directories(cvtflow_flags INTERFACE ${PROJECT_SOURCE_DIR})
# Code that waits for the libraries' code: tests and command lines. Half of a build is theirs.
add_library(cvtflow_outer INTERFACE)
target_compile_options(cvtflow_outer INTERFACE $<$<CONFIG:Release>:-O1>)
add_library(cvtflow_small INTERFACE)   # parts of FMUs that run seldom
target_compile_options(cvtflow_small INTERFACE $<$<CONFIG:Release>:-Os>)
add_library(cvtflow_tested INTERFACE)   # tests themselves
target_compile_options(cvtflow_tested INTERFACE $<$<CONFIG:Release>:-Og>)

# Instruction sets that the kernels are compiled for: all that a processor of this kind may have. Instrumented code has one, the simplest.
set(isas baseline)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  # MinGW's stack is aligned to 16 bytes, which GCC forgets where it stores wider vectors (bug 54412)
  if(NOT MINGW AND NOT CVTFLOW_SANITIZE AND NOT CMAKE_CXX_FLAGS_RELWITHDEBINFO MATCHES "--coverage")
    list(APPEND isas avx2 avx512)
  endif()
  set(flags_of_baseline -march=x86-64)
  set(flags_of_avx2 -march=x86-64-v3)
  set(flags_of_avx512 -march=x86-64-v4 -mprefer-vector-width=512)
endif()

# cvtflow_kernels(target isa): compiles a library of kernels for an instruction set.
function(cvtflow_kernels target isa)
  target_link_libraries(${target} PRIVATE cvtflow_flags)
  target_compile_options(${target} PRIVATE ${flags_of_${isa}} $<$<CONFIG:Debug>:-O2>)
  set_target_properties(${target} PROPERTIES CVTFLOW_KERNELS ON UNITY_BUILD OFF)
endfunction()
# The same in one lane, nothing vectorised: what the laboratory compares with.
function(cvtflow_one_lane_kernels target)
  target_include_directories(${target} BEFORE PRIVATE ${PROJECT_SOURCE_DIR}/bench/one_lane)
  target_link_libraries(${target} PRIVATE cvtflow_flags)
  target_compile_options(${target} PRIVATE ${flags_of_baseline} -fno-tree-vectorize)
endfunction()
