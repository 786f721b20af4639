# Compiles for 64-bit ARM on Debian (package g++-aarch64-linux-gnu), with -DCVTFLOW_CORE_ONLY=ON. Programs run by qemu-user (.ci/run arm).
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L /usr/aarch64-linux-gnu)
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)   # notes on how vectors are passed, which concern no other compiler here
