# What the folders' CMakeLists share.

# umbrage_folder(NAME SOURCES... [USES targets...]): the static library umbrage_NAME made of this folder. It sees the
# headers of the folders that it uses and no others: include paths are staged per target.
# -Wno-restrict: g++ 12 warns of std::string concatenation without cause (GCC bug 105651).
# -Wno-missing-field-initializers: rows of tables name the fields that matter.
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
  # The target sees its own folder as <folder>/file.h through a directory that holds nothing but that one link.
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set(stage ${PROJECT_BINARY_DIR}/include/${name})
  get_filename_component(parent ${stage}/${folder} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${stage}/${folder} SYMBOLIC)
  target_include_directories(umbrage_${name} ${scope} ${stage})
  target_link_libraries(umbrage_${name} ${scope} ${ARG_USES})
endfunction()

# umbrage_spirv(OUT shaders...): compiles shaders (NAME.comp, .vert, .frag) of this folder to build/spirv/spirv/NAME.inc;
# OUT is the list of those. Their words are NAME_spirv() of spirv/NAME.h. Where a NAME.cpu.cpp stands beside a shader, both
# are one kernel, NAME_kernel() of kernels/NAME.h. The templates of the two headers lie beside this file.
function(umbrage_spirv out)
  set(all "")
  set(build ${PROJECT_BINARY_DIR}/spirv)
  foreach(shader ${ARGN})
    cmake_path(GET shader PARENT_PATH folder)
    cmake_path(GET shader STEM name)
    set(words ${build}/spirv/${name}.inc)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/spirv.h.in ${build}/spirv/${name}.h @ONLY)
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/${name}.cpu.cpp)
      configure_file(${PROJECT_SOURCE_DIR}/cmake/kernel.h.in ${build}/kernels/${name}.h @ONLY)
    endif()
    add_custom_command(
      OUTPUT ${words}
      COMMAND ${GLSLC} --target-env=vulkan1.2 -Werror -I ${PROJECT_SOURCE_DIR} -MD -MF ${words}.d -MT ${words} -mfmt=num
              -o ${words} ${CMAKE_CURRENT_SOURCE_DIR}/${shader}
      DEPENDS ${shader}
      DEPFILE ${words}.d
      COMMENT "SPIR-V ${name}"
      VERBATIM)
    list(APPEND all ${words})
  endforeach()
  set(${out} ${all} PARENT_SCOPE)
endfunction()
