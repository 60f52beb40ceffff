# Debian packages by CPack, divided by the rules of Debian: umbrage, the programs and manual pages; umbrage-lab, the
# commands that measure; umbrage-import-cad, which reads STEP and IGES; libumbrage1, the shared library; libumbrage-dev, headers and static library; python3-umbrage, the
# Python package. scripts/package builds them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Umbrage authors <umbrage@localhost>")
set(CPACK_PACKAGE_VENDOR "Umbrage")
set(CPACK_COMPONENTS_ALL program lab library development python)
if(TARGET umbrage-import-cad)
  list(APPEND CPACK_COMPONENTS_ALL cad)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# The packages of each release have their own dependencies: 1~deb12, 1~deb13.
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
if(EXISTS /etc/os-release)
  file(STRINGS /etc/os-release system REGEX "^(ID=debian|VERSION_ID=)")
  if(system MATCHES "ID=debian" AND system MATCHES "VERSION_ID=\"([0-9]+)")
    string(APPEND CPACK_DEBIAN_PACKAGE_RELEASE ~deb${CMAKE_MATCH_1})
  endif()
endif()
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY >=)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME umbrage)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS fonts-dejavu-core)  # of legends
# Vulkan is loaded at run time if it is installed.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS libvulkan1)
set(CPACK_DEBIAN_LAB_PACKAGE_NAME umbrage-lab)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "glslc, spirv-cross, umbrage-import-cad")  # umbrage shaders, STEP
set(CPACK_DEBIAN_LAB_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_LAB_PACKAGE_RECOMMENDS libvulkan1)
# The program starts this one; it must have the same version.
set(CPACK_DEBIAN_LAB_PACKAGE_DEPENDS "umbrage (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(CPACK_DEBIAN_CAD_PACKAGE_NAME umbrage-import-cad)
set(CPACK_DEBIAN_CAD_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_CAD_PACKAGE_DEPENDS ${CPACK_DEBIAN_LAB_PACKAGE_DEPENDS})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libumbrage${UMBRAGE_ABI})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS libvulkan1)
# The library starts a program of package umbrage to read models; it must have the same version.
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "umbrage (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libumbrage-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libumbrage${UMBRAGE_ABI} (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
# Static linking and umbrage/vulkan.h need these.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS
    "libdeflate-dev, libembree-dev, libfmt-dev, libhwy-dev, libjpeg-dev, libopenexr-dev, libpng-dev, libtbb-dev, libtiff-dev, libvulkan-dev, libwebp-dev, libzip-dev, zlib1g-dev")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-umbrage)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "libumbrage${UMBRAGE_ABI} (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), python3 (>= 3.8), python3-numpy")
# Maintainer scripts compile the Python files at installation and remove the compiled files with the package.
foreach(script "postinst configure py3compile" "prerm remove|upgrade|deconfigure py3clean")
  string(REPLACE " " ";" script "${script}")
  list(GET script 0 name)
  list(GET script 1 when)
  list(GET script 2 command)
  file(CONFIGURE OUTPUT generated/debian/python/${name} CONTENT
"#!/bin/sh
set -e
case \"$1\" in
  @when@) if command -v @command@ >/dev/null; then @command@ -p python3-umbrage; fi ;;
esac
" @ONLY)
  file(CHMOD ${PROJECT_BINARY_DIR}/generated/debian/python/${name} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE
       GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  list(APPEND CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/generated/debian/python/${name})
endforeach()

# Long descriptions. The first line of each package's description is the description of the project.
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "Umbrage draws 3D models so that their shape can be read: ambient occlusion,
indirect light, soft shadows, toon shading, outlines. It reads OBJ, PLY,
STL, glTF, 3MF and more, writes PNG, JPEG, WebP, OpenEXR and PFM, and runs on
any CPU, without a display, or on a Vulkan GPU.")
set(CPACK_COMPONENT_LAB_DESCRIPTION
    "Umbrage draws 3D models so that their shape can be read. This package contains
the commands compare, tune, figures and bench: they measure techniques against
ray tracing, search settings, reproduce papers and measure times.")
set(CPACK_COMPONENT_CAD_DESCRIPTION
    "Umbrage draws 3D models so that their shape can be read. This package contains
the program that reads STEP and IGES files for it, through OpenCASCADE.")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
    "Umbrage draws 3D models so that their shape can be read, and shades what other
programs have drawn. This package contains the shared library.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "Umbrage draws 3D models so that their shape can be read, and shades what other
programs have drawn. This package contains the development files: headers,
static library, packages for CMake and pkg-config, examples.")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "Umbrage draws 3D models so that their shape can be read, and shades what other
programs have drawn. This package contains the Python package, which renders
models and shades arrays of NumPy and other libraries.")

# Debian requires license and changelog in a folder of each package. They are not part of a plain install.
find_program(GZIP gzip)
if(GZIP)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/generated/debian)
  file(CONFIGURE OUTPUT generated/debian/changelog.Debian CONTENT
"umbrage (@PROJECT_VERSION@-@CPACK_DEBIAN_PACKAGE_RELEASE@) unstable; urgency=medium

  * Built from source; see /usr/share/doc/umbrage/CHANGELOG.md for the changes.

 -- @CPACK_PACKAGE_CONTACT@  Thu, 01 Jan 2026 00:00:00 +0000
" @ONLY)
  execute_process(COMMAND ${GZIP} -9nkf ${PROJECT_BINARY_DIR}/generated/debian/changelog.Debian)
  file(READ LICENSE licence)
  string(REGEX REPLACE "\n\n" "\n.\n" licence "${licence}")
  string(REGEX REPLACE "\n([^\n])" "\n \\1" licence "${licence}")
  file(CONFIGURE OUTPUT generated/debian/copyright CONTENT
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: umbrage

Files: *
Copyright: 2026 The Umbrage authors
License: MIT
 @licence@" @ONLY)
  foreach(component ${CPACK_COMPONENTS_ALL})
    string(TOUPPER ${component} upper)
    install(FILES ${PROJECT_BINARY_DIR}/generated/debian/changelog.Debian.gz ${PROJECT_BINARY_DIR}/generated/debian/copyright
            DESTINATION share/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME} COMPONENT ${component} EXCLUDE_FROM_ALL)
  endforeach()
endif()
include(CPack)
