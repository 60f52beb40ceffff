// The table of what a Request can say: one row per option. From it come the command line with its help, manual
// page and completion, the checks of the library and what both say of a wrong value.
//
// Messages name a field in backquotes, `camera.zoom`; who speaks to people in other words puts them in its place. They
// quote what somebody wrote, such as the name of a file, in '...': there nothing is put in its place.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/length.h"
#include "core/numbers.h"
#include "core/result.h"
#include "renderer/request.h"

namespace umbrage {

/// Where a field is.
template <class T>
using FieldOf = T& (*)(Request&);
using Vector3 = std::array<float, 3>;
using Field = std::variant<std::monostate, FieldOf<bool>, FieldOf<int>, FieldOf<float>, FieldOf<std::optional<int>>,
                           FieldOf<std::optional<float>>, FieldOf<std::string>, FieldOf<std::vector<std::string>>,
                           FieldOf<std::vector<float>>, FieldOf<std::optional<Vector3>>>;

/// How a value is written, where its type alone does not say it.
enum class OptionForm {
  kPlain,
  kSize,       ///< width and height: "640,480" or "640x480"
  kPercent,    ///< "5%"
  kLength,     ///< "0.3" scene units, or "5%" of the scene
  kPosition,   ///< "1,2.5,-3"
  kDirection,  ///< the same, or "+Y"; not 0
  kColor,      ///< three numbers from 0 to 1
  kRotation,   ///< nine numbers
  kWindow,     ///< four numbers
  kWords,      ///< "depth,normal"
};

/// The commands that have an option, as bits.
enum OptionCommand : unsigned {
  kRender = 1,
  kCompare = 2,
  kTune = 4,
  kInfo = 8,
  kBench = 16,
  kFigures = 32,
  kShade = 64
};

struct Option {
  std::string_view field;  ///< its name in a program: "camera.zoom"
  std::string_view
      option;  ///< and on a command line, without dashes: "camera-zoom-factor"; empty: it has none of its own
  std::string_view group, help;
  std::string_view initial;  ///< what holds where nobody says, as help shows it; empty: it does not
  Field where;               ///< nothing: it is the command line's own, or the process's
  unsigned commands = kRender;
  double min = 0.0, max = 0.0;  ///< inclusive range of numbers
  OptionForm form = OptionForm::kPlain;
  std::string_view unit = {};                          ///< of numbers: "deg", "px", "%", "scene units"
  std::vector<std::string_view> choices = {};          ///< all that it takes; checked by set_option
  std::vector<std::string_view> (*names)() = nullptr;  ///< or the names that it takes, which make_recipe checks
  std::string_view environment = {};                   ///< the variable that stands for it on a command line
};

std::span<const Option> options();

/// The row of that field, which must be there.
const Option& option_of(std::string_view field);

/// A message with what `rename` makes of each field that it names in backquotes; none of them within '...'.
std::string with_fields_renamed(std::string_view message, std::string (*rename)(const Option&));

/// The words that it takes, of `choices` or `names`; empty where it takes others.
std::vector<std::string_view> words_of(const Option& option);

/// The numbers that it takes.
Interval interval_of(const Option& option);

/// Sets a field from text; flags take "true" and "false". Errors: kUsage.
Result<void> set_option(const Option& option, std::string_view text, Request& request);

/// Gives a field the value that it has where nobody sets it.
void reset_option(const Option& option, Request& request);

/// Checks one field's range and choices. Errors: kUsage.
Result<void> check_option(const Option& option, Request& request);

/// Checks everything of a request that can be wrong by itself: ranges, choices, and what contradicts each other. Of
/// names nothing. `most_pixels`: of the picture. Errors: kUsage.
Result<void> check_request(const Request& request, long most_pixels);

/// The words of a list parted by commas.
std::vector<std::string> split(std::string_view text);
/// "640,480" or "640x480". `field` is named in errors, here and below. Errors: kUsage.
Result<std::pair<int, int>> parse_size(std::string_view field, std::string_view text, long most_pixels);
/// "0.3" or "5%", above 0.
Result<Length> parse_length(std::string_view field, std::string_view text);
/// Of "full", "half" or "quarter": every how manieth pixel is computed, across and down.
Result<int> parse_scale(std::string_view field, std::string_view text);

/// The largest picture, and how many pixels, of all layers together, may be held at once: more need more memory than
/// most machines have (64 million take 8 GB and more). See renderer/bands.h for larger pictures.
inline constexpr int kMaxSide = 16384;
inline constexpr long kMaxPixels = 8192L * 8192L;
inline constexpr long kMaxBandPixels = 2L * kMaxSide * kMaxSide;

}  // namespace umbrage
