# Compiles for WebAssembly on Debian (package emscripten), with -DCVTFLOW_CORE_ONLY=ON. Programs run by node or in a browser (.ci/run web).
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -fexceptions -fvisibility=default -isystem ${CMAKE_CURRENT_LIST_DIR}/web -include ${CMAKE_CURRENT_LIST_DIR}/web/missing.hpp")
