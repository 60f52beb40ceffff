# Functions for the CMakeLists.txt of all folders.

# umbrage_folder(NAME SOURCES... [USES targets...]): adds the static library umbrage_NAME of this folder. It can include
# headers only of its own folder and of the folders that it uses, since include paths are staged per target.
# -Wno-restrict: g++ 12 has false positives for std::string concatenation (GCC bug 105651).
# -Wno-missing-field-initializers: table rows set only the relevant fields.
function(umbrage_folder name)
  cmake_parse_arguments(ARG "" "" "SOURCES;USES" ${ARGN})
  if(ARG_SOURCES)
    add_library(umbrage_${name} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    target_compile_options(umbrage_${name} PRIVATE -Wall -Wextra $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> -Wno-missing-field-initializers $<$<BOOL:${UMBRAGE_WERROR}>:-Werror>)
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
