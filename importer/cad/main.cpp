// umbrage-import-cad: reads a model of CAD for the host that starts it.
#include "importer/cad/cad.h"
#include "importer/common/serve_import.h"

int main(int argc, char** argv) {
  // Bodies are computed from surfaces, and curved ones take far more time and memory than their text.
  constexpr umbrage::ImportLimits kLimits{
      .base_seconds = 60.0, .seconds_per_megabyte = 20.0, .base_memory = 4e9, .memory_per_byte = 400.0};
  umbrage::serve_import(argc, argv, umbrage::import_cad, nullptr, kLimits);
}
