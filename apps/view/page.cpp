#include "apps/view/page.h"

namespace umbrage::view {

std::string_view page() {
  static constexpr char kPage[] =
#include "view_page.inc"
      ;
  return {kPage, sizeof kPage - 1};
}

}  // namespace umbrage::view
