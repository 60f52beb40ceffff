# Install rules, in six components: program, lab (umbrage-lab), cad (umbrage-import-cad), library (shared), development, python (only on request).
include(CMakePackageConfigHelpers)
# Builds what is installed, and no tests.
add_custom_target(umbrage_installation)
# CMake's own check comes file by file: without this one, an installation that lacks a file stops half-done.
# umbrage_built_for(COMPONENT TARGET FILE...): the target belongs to the installation, which begins only if the files exist.
function(umbrage_built_for component target)
  add_dependencies(umbrage_installation ${target})
  foreach(file ${ARGN})
    install(CODE "if(NOT EXISTS \"${file}\")
  message(FATAL_ERROR \"${file} is not built: build what is installed first, with cmake --build ${PROJECT_BINARY_DIR} --target umbrage_installation\")
endif()" COMPONENT ${component})
  endforeach()
endfunction()
umbrage_built_for(program umbrage $<TARGET_FILE:umbrage>)
umbrage_built_for(program umbrage-import $<TARGET_FILE:umbrage-import>)
if(TARGET umbrage_manual)
  umbrage_built_for(program umbrage_manual ${UMBRAGE_MANUAL})
endif()
umbrage_built_for(lab umbrage-lab $<TARGET_FILE:umbrage-lab>)
if(TARGET umbrage-import-cad)
  umbrage_built_for(cad umbrage-import-cad $<TARGET_FILE:umbrage-import-cad>)
endif()
if(TARGET umbrage_shared)
  umbrage_built_for(library umbrage_shared $<TARGET_FILE:umbrage_shared>)
endif()
if(TARGET umbrage_static)
  umbrage_built_for(development umbrage_static $<TARGET_FILE:umbrage_static>)
endif()
install(TARGETS umbrage RUNTIME COMPONENT program)
# The program and the library start umbrage-import to read models.
install(TARGETS umbrage-import RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/umbrage COMPONENT program)
if(TARGET umbrage-import-cad)
  install(TARGETS umbrage-import-cad RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/umbrage COMPONENT cad)
endif()
# umbrage starts umbrage-lab for the commands that measure.
install(TARGETS umbrage-lab RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/umbrage COMPONENT lab)
if(TARGET umbrage_shared)
  install(TARGETS umbrage_shared EXPORT umbrage-shared LIBRARY COMPONENT library NAMELINK_COMPONENT development)
endif()
if(TARGET umbrage_static)
  install(TARGETS umbrage_static EXPORT umbrage-static ARCHIVE COMPONENT development)
endif()
install(DIRECTORY include/umbrage TYPE INCLUDE COMPONENT development)
install(FILES LICENSE README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md SECURITY.md TYPE DOC COMPONENT program)
install(DIRECTORY docs TYPE DOC COMPONENT program PATTERN docs/site EXCLUDE)
# The pages link to the README of each effect and to the examples.
install(DIRECTORY effects reference TYPE DOC COMPONENT program FILES_MATCHING PATTERN README.md)
# The thumbnailer of file managers, and the MIME types that it names and shared-mime-info lacks.
install(DIRECTORY apps/share/ TYPE DATA COMPONENT program)
# The manual page and shell completions, which apps/CMakeLists.txt generates with the program.
if(TARGET umbrage_manual)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/share/ TYPE DATA COMPONENT program)
endif()
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT development
        FILES_MATCHING PATTERN "*.cpp" PATTERN "*.c" PATTERN "*.py" PATTERN "*.ipynb" PATTERN CMakeLists.txt)

# The folder is that of Debian's Python. Elsewhere use PYTHONPATH or scripts/wheel.
install(DIRECTORY python/umbrage DESTINATION lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL
        FILES_MATCHING PATTERN "*.py" PATTERN "*.inc" PATTERN py.typed PATTERN .mypy_cache EXCLUDE)
install(FILES examples/gallery.ipynb DESTINATION share/doc/python3-umbrage/examples COMPONENT python EXCLUDE_FROM_ALL)
install(DIRECTORY examples/python/ DESTINATION share/doc/python3-umbrage/examples COMPONENT python EXCLUDE_FROM_ALL
        FILES_MATCHING PATTERN "*.py")

# Files for find_package(umbrage).
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/umbrage)
foreach(kind ${UMBRAGE_KINDS})
  install(EXPORT umbrage-${kind} FILE umbrage-${kind}.cmake NAMESPACE umbrage:: DESTINATION ${package} COMPONENT development)
endforeach()
configure_package_config_file(cmake/umbrage-config.cmake.in generated/umbrage-config.cmake INSTALL_DESTINATION ${package}
                              NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change the API.
write_basic_package_version_file(generated/umbrage-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/generated/umbrage-config.cmake ${PROJECT_BINARY_DIR}/generated/umbrage-config-version.cmake
        DESTINATION ${package} COMPONENT development)

# The file for pkg-config. Its paths are relative to the .pc file, so that the installed tree can be moved. Folders outside the prefix
# are absolute.
set(pkgconfig ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
cmake_path(IS_ABSOLUTE CMAKE_INSTALL_LIBDIR absolute_lib)
cmake_path(IS_ABSOLUTE CMAKE_INSTALL_INCLUDEDIR absolute_include)
set(pc_prefix ${CMAKE_INSTALL_PREFIX})
if(NOT absolute_lib)
  file(RELATIVE_PATH up /${pkgconfig} /)
  string(REGEX REPLACE "/$" "" up ${up})
  set(pc_prefix "\${pcfiledir}/${up}")
endif()
set(pc_lib "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
set(pc_include "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
if(absolute_lib)
  set(pc_lib ${CMAKE_INSTALL_LIBDIR})
endif()
if(absolute_include)
  set(pc_include ${CMAKE_INSTALL_INCLUDEDIR})
endif()
# Libraries for static linking. Requires.private is not used: it would require the development packages of these
# libraries for dynamic linking too.
pkg_check_modules(PC_PRIVATE QUIET fmt libdeflate libhwy libjpeg libpng libtiff-4 libwebp libzip OpenEXR tbb zlib)
if(NOT PC_PRIVATE_FOUND)
  message(STATUS "pkg-config does not find all libraries: umbrage.pc will not support static linking")
endif()
list(JOIN PC_PRIVATE_LDFLAGS " " pc_private)
string(APPEND pc_private " -lembree${embree_VERSION_MAJOR} -lstdc++ -lm -ldl -pthread")
configure_file(cmake/umbrage.pc.in generated/umbrage.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/generated/umbrage.pc DESTINATION ${pkgconfig} COMPONENT development)
