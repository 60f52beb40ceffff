#include "core/version.h"

namespace umbrage {

std::string_view project_version() { return UMBRAGE_VERSION; }

}  // namespace umbrage
