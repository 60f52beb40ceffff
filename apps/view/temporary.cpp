#include "apps/view/temporary.h"

#include <cstdlib>
#include <string>

namespace umbrage::view {

namespace fs = std::filesystem;

Result<TemporaryFolder> TemporaryFolder::create() {
  std::error_code code;
  const fs::path place = fs::temp_directory_path(code);
  std::string path = (place / "umbrage-view-XXXXXX").string();
  if (code || !::mkdtemp(path.data()))  // mkdtemp lets only the owner in
    return file_error("the temporary folder for uploads cannot be created in '{}'", place.string());
  return TemporaryFolder(path);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace umbrage::view
