// umbrage info of image files: their layers, and how a G-buffer in them was understood.
#pragma once
#include <string>

#include "apps/cli/options.h"

namespace umbrage::cli {

/// Returns whether the files of the options are images rather than models, by content or extension.
bool has_image(const CommonOptions& options);

/// Prints layers, facts and warnings as text or JSON, and draws a picture of all layers unless `contact_sheet` is
/// empty. Errors: kUsage; kFile.
Result<void> print_image_info(const CommonOptions& options, bool json, const std::string& contact_sheet);

}  // namespace umbrage::cli
