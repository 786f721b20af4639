# Where programs look for shared libraries. CMake ends the search path of a target that is built to be installed with an empty element, which
# the loader takes for the current folder: a library placed there would run. So targets have the search path of their installation from the
# beginning: none where all libraries are in the system's folders.
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)   # libraries elsewhere, as a HDF5 of one's own

# Debian's HDF5 is a link, in a folder of its own, to a library in a folder of the system.
foreach(library hdf5::hdf5 hdf5::hdf5_hl)
  if(TARGET ${library})
    get_target_property(location ${library} IMPORTED_LOCATION)
    if(location)
      file(REAL_PATH "${location}" location)
      set_target_properties(${library} PROPERTIES IMPORTED_LOCATION "${location}")
    endif()
  endif()
endforeach()
