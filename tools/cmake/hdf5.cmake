# HDF5 for every target, as cvtflow_hdf5. Programs link the archive of Debian's package: its shared library loads curl, OpenSSL and Kerberos, half of the
# time of a start. The archive has no position-independent code, so our shared libraries need the shared one.
# -DHDF5_USE_STATIC_LIBRARIES=OFF, a variable of CMake's search, takes the shared one everywhere: for packages of a distribution.
find_package(HDF5 REQUIRED COMPONENTS C HL)
find_package(ZLIB REQUIRED)
find_library(CVTFLOW_SZIP sz)
mark_as_advanced(CVTFLOW_SZIP)
set(archives "")
foreach(name hdf5_hl hdf5)
  get_target_property(library hdf5::${name} IMPORTED_LOCATION)
  file(REAL_PATH "${library}" library)   # Debian's is a link, in a separate folder, to a library in a folder of the system
  set_target_properties(hdf5::${name} PROPERTIES IMPORTED_LOCATION "${library}")
  string(REGEX REPLACE "\\.so[.0-9]*$" ".a" archive "${library}")
  if(archive MATCHES "\\.a$" AND EXISTS "${archive}")
    list(APPEND archives ${archive})
  endif()
endforeach()
list(LENGTH archives found)
add_library(cvtflow_hdf5 INTERFACE)
target_include_directories(cvtflow_hdf5 SYSTEM INTERFACE $<TARGET_PROPERTY:hdf5::hdf5,INTERFACE_INCLUDE_DIRECTORIES>)
if(found EQUAL 2 AND CVTFLOW_SZIP AND (NOT DEFINED HDF5_USE_STATIC_LIBRARIES OR HDF5_USE_STATIC_LIBRARIES))
  set(program $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
  target_link_libraries(cvtflow_hdf5 INTERFACE "$<${program}:${archives};${CVTFLOW_SZIP};ZLIB::ZLIB;${CMAKE_DL_LIBS};m>"
    "$<$<NOT:${program}>:hdf5::hdf5;hdf5::hdf5_hl>")
else()
  target_link_libraries(cvtflow_hdf5 INTERFACE hdf5::hdf5 hdf5::hdf5_hl)
endif()
