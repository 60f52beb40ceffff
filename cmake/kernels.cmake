# Kernels and shaders. The text NAME.kernel.h is one kernel if it defines NAME_pixel. A text with lines such as
#   // KERNEL box_down: ALONG_ROWS=0 SOURCE=box_row TARGET=ao
# is one kernel for each of these lines, compiled with these macros. Each kernel is compiled as scalar code, as SIMD lanes
# and to SPIR-V.

set(UMBRAGE_SPIRV ${PROJECT_BINARY_DIR}/spirv)
# Number of kernels in a source file: they share the time to compile Highway, but run on one core.
set(UMBRAGE_KERNELS_PER_FILE 4)

# umbrage_spirv(OUT shaders...): compiles shaders (NAME.comp, .vert, .frag) to build/spirv/spirv/NAME.inc and sets OUT to
# the list of those files. NAME_spirv() in spirv/NAME.h returns the SPIR-V.
function(umbrage_spirv out)
  set(all "")
  foreach(shader ${ARGN})
    cmake_path(ABSOLUTE_PATH shader)
    cmake_path(GET shader STEM name)
    set(words ${UMBRAGE_SPIRV}/spirv/${name}.inc)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/spirv.h.in ${UMBRAGE_SPIRV}/spirv/${name}.h @ONLY)
    add_custom_command(
      OUTPUT ${words}
      COMMAND ${GLSLC} --target-env=vulkan1.2 -Werror -I ${PROJECT_SOURCE_DIR} -I ${UMBRAGE_SPIRV} -MD -MF ${words}.d
              -MT ${words} -mfmt=num -o ${words} ${shader}
      DEPENDS ${shader}
      DEPFILE ${words}.d
      COMMENT "SPIR-V ${name}"
      VERBATIM)
    list(APPEND all ${words})
  endforeach()
  set(${out} ${all} PARENT_SCOPE)
endfunction()

# Numbers the planes of all kernels in kernels/plane_ids.h, for the specialization constants of kernel/glsl.h: four ids
# for a name, 25 for the planes that every layer has. glslc limits ids to 2047.
function(umbrage_number_planes)
  file(GLOB texts CONFIGURE_DEPENDS effects/*/*.kernel.h effects/*/*.comp kernel/*.kernel.h devices/shared/*.kernel.h)
  set(names "")
  set(layered "")
  foreach(text ${texts})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${text})
    file(STRINGS ${text} declarations REGEX "^(IN|OUT|INOUT)_|^PLANE\\(|^// KERNEL ")
    string(REGEX MATCHALL "(\\(|, |=)[a-z][a-z0-9_]*" found "${declarations}")
    list(APPEND names ${found})
    string(REGEX MATCHALL "LAYERS_[A-Z_]+\\(([A-Z]+, )?[a-z0-9_]+" found "${declarations}")
    list(APPEND layered ${found})
  endforeach()
  list(TRANSFORM names REPLACE "[(, =]+" "")
  list(TRANSFORM layered REPLACE ".*[( ]" "")
  list(REMOVE_DUPLICATES names)
  list(SORT names)
  set(ids "")
  set(id 1) # 0 is bound_planes
  foreach(name ${names})
    string(APPEND ids "#define ID_${name} ${id}\n")
    if(name IN_LIST layered)
      math(EXPR id "${id} + 25")
    else()
      math(EXPR id "${id} + 4")
    endif()
  endforeach()
  file(CONFIGURE OUTPUT ${UMBRAGE_SPIRV}/kernels/plane_ids.h CONTENT "${ids}")
endfunction()

# umbrage_kernels(OUT FOLDER NAME): sets OUT to the source files of the kernels of a folder, which it writes. FOLDER is
# relative to the root of the tree; its file NAME.h has the struct of the kernels' constants. KERNEL_kernel() in
# kernels/KERNEL.h returns a kernel.
function(umbrage_kernels out folder name)
  set(header ${folder}/${name}.h)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${header})
  file(STRINGS ${PROJECT_SOURCE_DIR}/${header} constants REGEX "^struct [A-Za-z]+Constants")
  string(REGEX REPLACE "^struct ([A-Za-z]+).*" "\\1" constants "${constants}")
  set(sources "")
  set(shaders "")
  set(blocks "")
  set(count 0)
  file(GLOB texts CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${folder}/*.kernel.h)
  foreach(text ${texts})
    file(STRINGS ${PROJECT_SOURCE_DIR}/${text} entry REGEX "^FN void [a-z0-9_]+_pixel\\(" LIMIT_COUNT 1)
    if(NOT entry)
      continue()
    endif()
    string(REGEX REPLACE "^FN void ([a-z0-9_]+)_pixel.*" "\\1" entry "${entry}")
    file(STRINGS ${PROJECT_SOURCE_DIR}/${text} variants REGEX "^// KERNEL ")
    if(NOT variants)
      set(variants "// KERNEL ${entry}:")
    endif()
    foreach(variant ${variants})
      string(REGEX REPLACE "^// KERNEL ([a-z0-9_]+):.*" "\\1" kernel "${variant}")
      string(REGEX MATCHALL "[A-Z_]+=[A-Za-z0-9_]+" macros "${variant}")
      set(define "")
      set(undefine "")
      foreach(macro ${macros})
        string(REPLACE "=" " " macro ${macro})
        string(APPEND define "#define ${macro}\n")
        string(REGEX REPLACE " .*" "" macro ${macro})
        string(APPEND undefine "#undef ${macro}\n")
      endforeach()
      configure_file(${PROJECT_SOURCE_DIR}/cmake/kernel.comp.in ${UMBRAGE_SPIRV}/kernels/${kernel}.comp @ONLY)
      configure_file(${PROJECT_SOURCE_DIR}/cmake/kernel.h.in ${UMBRAGE_SPIRV}/kernels/${kernel}.h @ONLY)
      list(APPEND shaders ${UMBRAGE_SPIRV}/kernels/${kernel}.comp)
      string(REPLACE ";" " " words "${macros}")
      set_property(GLOBAL APPEND PROPERTY UMBRAGE_KERNELS "${kernel}|${entry}|${text}|${header}|${constants}|${words}")
      string(APPEND blocks "
${define}#define UMBRAGE_KERNEL ${kernel}
#define UMBRAGE_KERNEL_PIXEL ${entry}_pixel
#define UMBRAGE_KERNEL_TEXT \"${text}\"
#include \"kernel/cpu_kernel.h\"
${undefine}")
      math(EXPR place_in_file "${count} % ${UMBRAGE_KERNELS_PER_FILE}")
      if(place_in_file EQUAL 0)
        set(source kernels/${name}_${count}.cpp)
        list(APPEND sources ${source})
        set(blocks_of_${source} "")
      endif()
      string(APPEND blocks_of_${source} "${blocks}")
      set(blocks "")
      math(EXPR count "${count} + 1")
    endforeach()
  endforeach()
  foreach(source ${sources})
    set(blocks "${blocks_of_${source}}")
    configure_file(${PROJECT_SOURCE_DIR}/cmake/kernels.cpp.in ${UMBRAGE_SPIRV}/${source} @ONLY)
  endforeach()
  list(TRANSFORM sources PREPEND ${UMBRAGE_SPIRV}/)
  set_source_files_properties(${sources} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  umbrage_spirv(spirv ${shaders})
  set(${out} ${sources} ${spirv} PARENT_SCOPE)
endfunction()
