// Lines of a picture, as the public interface hands them out.
#pragma once
#include <filesystem>

#include "renderer/recipe.h"
#include "umbrage/umbrage.h"

namespace umbrage {

/// The parameters of the lines that the recipe's look or effects draw; empty unless strokes are wanted. Errors: those
/// of line_parameters.
Result<ParameterBytes> wanted_lines(bool strokes, const Recipe& recipe);

/// Adds the lines of a drawn frame to its picture; `outline_params` are those of wanted_lines. Errors: those of
/// Device::download.
Result<void> add_strokes(Device& device, const Frame& frame, const ParameterBytes& outline_params, Picture& picture);

/// Writes a picture's strokes as .svg. Errors: kUsage where it has none, or some with points that are no numbers;
/// kFile.
Result<void> write_strokes(const Picture& picture, const std::filesystem::path& file);

}  // namespace umbrage
