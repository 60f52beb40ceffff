// umbrage-import: reads a model or a panorama for the host that starts it.
#include "importer/importer.h"
#include "scene/readers/texture_file.h"

int main(int argc, char** argv) {
  constexpr bool kProcessEnds = true;
  umbrage::serve_import(
      argc, argv,
      [](const std::filesystem::path& file, const umbrage::ImportSettings& settings) {
        return umbrage::import_in_process(file, settings, kProcessEnds);
      },
      umbrage::read_panorama);
}
