# Functions for the CMakeLists.txt of all folders.

# umbrage_folder(NAME SOURCES... [USES targets...]): adds the static library umbrage_NAME of this folder. It can include
# headers only of its own folder and of the folders that it uses, since include paths are staged per target.
# Files are compiled together in groups, since most of the time goes into headers; UMBRAGE_UNITY=OFF compiles each alone.
# -O1: half the time of a compilation at -O3 is optimization, which only kernels and inner loops need. Folders with these
# add -O2 or -O3.
function(umbrage_folder name)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES" ${ARGN})
  if(ARG_SOURCES)
    add_library(umbrage_${name} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    set_target_properties(umbrage_${name} PROPERTIES UNITY_BUILD ${UMBRAGE_UNITY} UNITY_BUILD_BATCH_SIZE 8)
    target_compile_options(umbrage_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  else()
    add_library(umbrage_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  # The target includes its own headers as <folder>/file.h through a directory that contains only a link to the folder.
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set(stage ${PROJECT_BINARY_DIR}/include/${name})
  get_filename_component(parent ${stage}/${folder} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${stage}/${folder} SYMBOLIC)
  target_include_directories(umbrage_${name} ${scope} ${stage})
  target_link_libraries(umbrage_${name} ${scope} ${ARG_USES})
endfunction()
