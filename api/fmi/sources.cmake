# Gathers the sources of an FMU's library with every header that they include, so that a compiler with no other file builds it:
#   cmake -D OUT=folder -D SOURCES=list -D TOP=folder of the project -D PLACES=list -P sources.cmake       PLACES: of <fmt/…> and the like
# OUT/groups has what to compile: the sources of a folder, which share one space of local names; kernels and fmt's code by themselves.
file(REMOVE_RECURSE ${OUT})
list(PREPEND PLACES ${TOP}/api/include ${TOP})
set(open ${SOURCES})
set(groups "")
foreach(source ${SOURCES})
  cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${TOP} OUTPUT_VARIABLE name)
  cmake_path(GET name PARENT_PATH group)
  if(name MATCHES "_kernels\\.cpp$|^engine/alone/")
    cmake_path(REMOVE_EXTENSION name OUTPUT_VARIABLE group)
  endif()
  string(REPLACE "/" "_" group ${group})
  list(APPEND groups ${group})
  string(APPEND text_of_${group} "#include \"${name}\"\n")
endforeach()
list(REMOVE_DUPLICATES groups)
foreach(group ${groups})
  file(WRITE ${OUT}/groups/${group}.cpp "${text_of_${group}}")
endforeach()

while(open)   # every file is copied once, and what it includes is open
  list(POP_FRONT open file)
  if(DEFINED seen_${file})
    continue()
  endif()
  set(seen_${file} TRUE)
  foreach(place ${PLACES})
    cmake_path(IS_PREFIX place ${file} inside)
    if(inside)
      cmake_path(RELATIVE_PATH file BASE_DIRECTORY ${place} OUTPUT_VARIABLE name)
      break()
    endif()
  endforeach()
  cmake_path(GET file PARENT_PATH folder)
  cmake_path(GET name PARENT_PATH target)
  file(COPY ${file} DESTINATION ${OUT}/${target})
  file(STRINGS ${file} lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
  foreach(line ${lines})
    string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*)[>\"].*" "\\1" included "${line}")
    foreach(place ${folder} ${PLACES})
      if(EXISTS ${place}/${included} AND (place STREQUAL folder OR included MATCHES "/"))   # else of the system
        cmake_path(NORMAL_PATH place OUTPUT_VARIABLE place)
        set(path ${place}/${included})
        cmake_path(NORMAL_PATH path)
        list(APPEND open ${path})
        break()
      endif()
    endforeach()
  endforeach()
endwhile()

# Kernels of the instruction set that the compiler is told, at best -march=native: every one gives the same bits.
string(CONCAT CVTFLOW_KERNEL_DECLARATIONS "template <>\nChainKernels chain_kernels<compiled_isa>() noexcept;\n"
  "template <>\nFrictionKernels friction_kernels<compiled_isa>() noexcept;\n"
  "template <>\nRigidKernels rigid_kernels<compiled_isa>() noexcept;\n")
set(CVTFLOW_KERNEL_ROWS
  "        {compiled_isa, chain_kernels<compiled_isa>, friction_kernels<compiled_isa>, rigid_kernels<compiled_isa>},\n")
configure_file(${TOP}/model/kernels/compiled_kernels.cpp.in ${OUT}/groups/compiled_kernels.cpp @ONLY)
file(READ ${OUT}/groups/compiled_kernels.cpp text)
file(WRITE ${OUT}/groups/compiled_kernels.cpp "#include \"model/basis/native_lanes.hpp\"\n${text}")
file(WRITE ${OUT}/groups/embedded_files.cpp "#include \"engine/base/input_file.hpp\"\n"
  "std::span<const cvtflow::engine::EmbeddedFile> cvtflow::engine::embedded_files() noexcept { return {}; }\n")
