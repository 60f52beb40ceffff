// A model on standard input: put into a file, since most readers want one.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/options.h"
#include "renderer/models.h"

namespace umbrage::cli {

/// The format of a model by its first bytes, as its file's name would end; empty where they say nothing.
std::string format_of_content(std::string_view bytes);

/// Errors: kUsage for `-` given twice, or a format that is none or of no use.
Result<void> check_standard_input(const std::vector<std::string>& models, const std::string& format);

/// load_scenes, where `-` stands for standard input: its format is `format`, or told by its content where that is
/// empty. Errors: those of check_standard_input and load_scenes.
Result<Scene> load_models(const std::vector<std::string>& models, const std::string& format,
                          const ImportSettings& settings);

/// What reads each of the models alone, where they have passed check_standard_input.
std::function<Result<Scene>(const std::string&, const ImportSettings&)> loader_of(const CommonOptions& options);

/// Removes the file behind standard input, if there is one. For signal handlers.
void drop_standard_input();

}  // namespace umbrage::cli
