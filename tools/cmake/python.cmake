# The Python package: copied to the build folder, where program and tests find it, and installed with the program.
set(CVTFLOW_PYTHON_DIR lib/python3/dist-packages)   # below a prefix
if(Python3_EXECUTABLE)
  # Place of modules below a prefix.
  execute_process(COMMAND ${Python3_EXECUTABLE} -c "import os, sysconfig
schemes = sysconfig.get_scheme_names()
scheme = 'deb_system' if 'deb_system' in schemes else 'posix_prefix'
print(os.path.relpath(sysconfig.get_path('platlib', scheme, {'platbase': '/p', 'base': '/p'}), '/p'))"
    OUTPUT_VARIABLE place OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(CVTFLOW_PYTHON_DIR ${place})
  endif()
endif()
set(python_prefix ${PROJECT_BINARY_DIR}/prefix/cvtflow)   # in the build folder
set(python_package ${python_prefix}/${CVTFLOW_PYTHON_DIR}/cvtflow)
file(GLOB_RECURSE python_files RELATIVE ${PROJECT_SOURCE_DIR}/api/python/cvtflow CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/api/python/cvtflow/*)
list(FILTER python_files EXCLUDE REGEX "__pycache__")
foreach(file ${python_files})
  configure_file(${PROJECT_SOURCE_DIR}/api/python/cvtflow/${file} ${python_package}/${file} COPYONLY)
endforeach()
configure_file(${PROJECT_SOURCE_DIR}/LICENSE ${python_package}/fmu/LICENSE COPYONLY)   # FMUs contain it
cmake_path(SET python_modules NORMALIZE ${python_prefix}/${CVTFLOW_PYTHON_DIR})
if(NOT IS_SYMLINK ${PROJECT_BINARY_DIR}/python)
  file(REMOVE_RECURSE ${PROJECT_BINARY_DIR}/python)   # the module's folder of earlier versions
endif()
file(CREATE_LINK ${python_modules} ${PROJECT_BINARY_DIR}/python SYMBOLIC)

# Installs the package's texts.
function(cvtflow_install_package)
  foreach(file ${python_files})
    cmake_path(GET file PARENT_PATH folder)
    install(FILES ${PROJECT_SOURCE_DIR}/api/python/cvtflow/${file} DESTINATION ${CVTFLOW_PYTHON_DIR}/cvtflow/${folder})
  endforeach()
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CVTFLOW_PYTHON_DIR}/cvtflow/fmu)
endfunction()
