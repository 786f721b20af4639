# The Python package: copied to the build folder, where program and tests find it, and installed with the program. Only the compiled module in it
# (api/python) requires more than an interpreter.
set(CVTFLOW_PYTHON_DIR lib/python3/dist-packages)   # below a prefix
set(python_include "")
if(Python3_EXECUTABLE)
  # Include folder, suffix of modules, place of modules below a prefix.
  execute_process(COMMAND ${Python3_EXECUTABLE} -c "import os, sysconfig
schemes = sysconfig.get_scheme_names()
scheme = 'deb_system' if 'deb_system' in schemes else 'posix_prefix'
print(sysconfig.get_path('include'), sysconfig.get_config_var('EXT_SUFFIX'),
      os.path.relpath(sysconfig.get_path('platlib', scheme, {'platbase': '/p', 'base': '/p'}), '/p'), sep=';')"
    OUTPUT_VARIABLE answers OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    list(GET answers 0 python_include)
    list(GET answers 1 python_suffix)
    list(GET answers 2 CVTFLOW_PYTHON_DIR)
  endif()
endif()
set(python_prefix ${PROJECT_BINARY_DIR}/prefix/cvtflow)   # in the build folder
set(python_package ${python_prefix}/${CVTFLOW_PYTHON_DIR}/cvtflow)
file(GLOB_RECURSE python_files RELATIVE ${PROJECT_SOURCE_DIR}/api/python/cvtflow CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/api/python/cvtflow/*)
list(FILTER python_files EXCLUDE REGEX "__pycache__")
foreach(file ${python_files})
  configure_file(${PROJECT_SOURCE_DIR}/api/python/cvtflow/${file} ${python_package}/${file} COPYONLY)
endforeach()
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
endfunction()
