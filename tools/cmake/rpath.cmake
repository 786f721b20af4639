# Where programs look for shared libraries. CMake ends the search path of a target that is built to be installed with an empty element, which
# the loader takes for the current folder: a library placed there would run. So targets have the search path of their installation from the
# beginning: none where all libraries are in the system's folders.
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)   # libraries elsewhere, as a user's HDF5
