# libumbrage: the public API and all internal libraries as one library, shared and static. Both are made of the same
# objects. If BUILD_SHARED_LIBS is set, it selects one of them.
set(UMBRAGE_ABI 1) # ABI version, the SOVERSION of the shared library
set(objects "")
foreach(folder core system kernel chains effects looks program scene scene_readers generators rays reference devices_shared devices_cpu devices_vulkan io gbuffers renderer library)
  list(APPEND objects $<TARGET_OBJECTS:umbrage_${folder}>)
endforeach()

# umbrage_library(shared|static KIND): adds one kind of the library. Highway and others have no CMake package that users of
# the installed library could find, so they are linked by name.
function(umbrage_library kind)
  add_library(umbrage_${kind} ${ARGN} ${objects})
  set_target_properties(umbrage_${kind} PROPERTIES OUTPUT_NAME umbrage EXPORT_NAME ${kind} LINKER_LANGUAGE CXX)
  target_compile_features(umbrage_${kind} INTERFACE cxx_std_17)
  target_include_directories(umbrage_${kind} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                       $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(
    umbrage_${kind} PRIVATE embree fmt::fmt JPEG::JPEG OpenEXR::OpenEXR PNG::PNG TBB::tbb TIFF::TIFF ZLIB::ZLIB
                            $<BUILD_INTERFACE:PkgConfig::DEFLATE> $<INSTALL_INTERFACE:deflate>
                            $<BUILD_INTERFACE:PkgConfig::HWY> $<INSTALL_INTERFACE:hwy>
                            $<BUILD_INTERFACE:PkgConfig::ZIP> $<INSTALL_INTERFACE:zip>
                            $<BUILD_INTERFACE:PkgConfig::WEBP> $<INSTALL_INTERFACE:webp> ${CMAKE_DL_LIBS})
endfunction()

include(GNUInstallDirs)
set(UMBRAGE_KINDS "")
if(BUILD_SHARED_LIBS OR NOT DEFINED BUILD_SHARED_LIBS)
  umbrage_library(shared SHARED)
  set(map ${CMAKE_CURRENT_LIST_DIR}/library.map)
  # The version script also hides symbols of third-party templates.
  target_link_options(umbrage_shared PRIVATE LINKER:--version-script=${map} LINKER:--no-undefined LINKER:--exclude-libs,ALL)
  set_target_properties(umbrage_shared PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${UMBRAGE_ABI} LINK_DEPENDS ${map})
  list(APPEND UMBRAGE_KINDS shared)
endif()
if(NOT BUILD_SHARED_LIBS)
  umbrage_library(static STATIC)
  list(APPEND UMBRAGE_KINDS static)
endif()
list(GET UMBRAGE_KINDS 0 kind)
add_library(umbrage::umbrage ALIAS umbrage_${kind})
