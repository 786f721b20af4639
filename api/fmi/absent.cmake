# Stand-ins for what an FMU never calls: writes OUTPUT, an assembly file that defines the names of HDF5, oneTBB and OpenMP that ARCHIVES want.
# An FMU runs on its caller's thread and reads no HDF5 file. Functions of HDF5 say that they failed, the others end the program.
#   cmake -DNM=… -DOUTPUT=… -DARCHIVES=a;b -P absent.cmake
execute_process(COMMAND ${NM} -u ${ARCHIVES} OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[ \t]U [A-Za-z0-9_]+" names "${names}")
list(REMOVE_DUPLICATES names)
set(text ".section .note.GNU-stack,\"\",@progbits\n.text\n.Lfailed:\n mov $-1, %rax\n ret\n.Labsent:\n ud2\n")
set(data ".data\n")
foreach(name ${names})
  string(REGEX REPLACE "^[ \t]U " "" name "${name}")
  if(name MATCHES "^H5.*_g$")
    string(APPEND data ".globl ${name}\n.hidden ${name}\n${name}: .quad -1\n")
  elseif(name MATCHES "^H5")
    string(APPEND text ".globl ${name}\n.hidden ${name}\n.set ${name}, .Lfailed\n")
  elseif(name MATCHES "^(GOMP_|omp_|_ZN3tbb|TBB_)")
    string(APPEND text ".globl ${name}\n.hidden ${name}\n.set ${name}, .Labsent\n")
  endif()
endforeach()
file(WRITE ${OUTPUT} "${text}${data}")
