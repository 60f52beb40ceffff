# CMake toolchain file: cross-compiles on Debian 12 for 64-bit ARM with the sysroot UMBRAGE_SYSROOT,
# which scripts/sysroot makes. The programs run under qemu.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES UMBRAGE_SYSROOT)
set(CMAKE_SYSROOT ${UMBRAGE_SYSROOT})
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L ${UMBRAGE_SYSROOT})

# Build tools come from this machine; libraries, headers and packages from the sysroot.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} ${UMBRAGE_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${UMBRAGE_SYSROOT}/usr/share/pkgconfig)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${UMBRAGE_SYSROOT})
