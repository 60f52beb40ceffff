# Writes the commit of the source tree SOURCE to the C++ header OUTPUT, unless it is there already: its hash, with "+" if
# tracked files differ from it, or "unknown" where there is no repository, as in an archive of the sources.
set(failed 1)
if(EXISTS ${SOURCE}/.git)
  execute_process(COMMAND git -C ${SOURCE} describe --always --abbrev=10 --dirty=+ --exclude=*
                  OUTPUT_VARIABLE commit RESULT_VARIABLE failed ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
if(failed OR NOT commit)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "inline constexpr const char* kCommit = \"${commit}\";\n")
