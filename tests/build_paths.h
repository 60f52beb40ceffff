// Paths of this build that tests need. They are defined in support.cpp alone, so that a compiler cache can share the
// objects of all other tests between folders.
#pragma once

namespace umbrage::test {

extern const char* const kProgram;       ///< the program umbrage
extern const char* const kFaultyImport;  ///< umbrage-import-faulty, a reader that crashes
extern const char* const kSourceFolder;  ///< the root of the sources

}  // namespace umbrage::test
