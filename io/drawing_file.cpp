#include "io/drawing_file.h"

#include "io/dxf.h"
#include "io/format.h"
#include "io/svg.h"

namespace umbrage {

std::string drawing_extension(const std::filesystem::path& file) {
  std::string extension = lowercase_extension(file);
  return extension == "svg" || extension == "dxf" ? extension : std::string();
}

Result<void> write_drawing(const std::filesystem::path& file, const Drawing& drawing) {
  const std::string extension = drawing_extension(file);
  if (extension.empty()) return usage_error("'{}' cannot hold a drawing: .svg and .dxf files do", file.string());
  const auto text = extension == "dxf" ? dxf_text(drawing) : svg_text(drawing);
  return text ? write_text(file, *text) : text.error();
}

}  // namespace umbrage
