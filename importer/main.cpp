// umbrage-import: reads a model for the program that starts it.
#include "importer/import_here.h"
#include "importer/serve.h"

int main(int argc, char** argv) {
  constexpr bool kProcessEnds = true;
  umbrage::serve_import(argc, argv, [](const std::filesystem::path& file, const umbrage::ImportSettings& settings) {
    return umbrage::import_here(file, settings, kProcessEnds);
  });
}
