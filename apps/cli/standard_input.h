// A model on standard input. It is copied to a temporary file, since most readers need a file.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "apps/cli/options.h"
#include "renderer/models.h"

namespace umbrage::cli {

/// Checks the models and --input-format. Errors: kUsage for `-` given twice, an unknown format, or a format without
/// `-`.
Result<void> check_standard_input(const std::vector<std::string>& models, const std::string& format);

/// Calls load_scenes, with `-` replaced by the copy of standard input. `format` is the format of standard input; if
/// empty, it is detected from the content. Errors: those of check_standard_input and load_scenes.
Result<Scene> load_models(const std::vector<std::string>& models, const std::string& format,
                          const ImportSettings& settings);

/// Returns a function that reads one of the models. The models must have passed check_standard_input.
std::function<Result<Scene>(const std::string&, const ImportSettings&)> loader_of(const CommonOptions& options);

/// Calls `work` with the path of a copy of standard input, an image, which exists during the call. Errors: those of
/// `work`; kUsage and kFile if standard input is a terminal, empty or cannot be copied.
Result<void> with_image_on_standard_input(const std::function<Result<void>(const std::string& file)>& work);

/// Removes the temporary copy of standard input, if it exists. Async-signal-safe.
void remove_standard_input_copy();

}  // namespace umbrage::cli
