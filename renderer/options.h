// The table of options: one row per field of Request. It defines the command line with its help, manual page and
// completion, the checks of the library, and the error messages of both.
//
// Messages name a field in backquotes, `camera.zoom`; the command line shows its option instead. User text, such as a
// file name, is quoted in '...', where nothing is replaced. What an error is about is in Error::fields.
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

/// Accesses a field of a request.
template <class T>
using FieldOf = T& (*)(Request&);
using Vector3 = std::array<float, 3>;
using Position = std::array<double, 3>;
using OptionField =
    std::variant<std::monostate, FieldOf<bool>, FieldOf<int>, FieldOf<float>, FieldOf<std::optional<int>>,
                 FieldOf<std::optional<float>>, FieldOf<std::string>, FieldOf<std::vector<std::string>>,
                 FieldOf<std::vector<float>>, FieldOf<std::optional<Vector3>>, FieldOf<std::optional<Position>>>;

/// The syntax of a value, if its type does not determine the syntax.
enum class OptionForm {
  kPlain,
  kSize,        ///< width and height: "640,480", "640x480", or "512" for a square
  kPercent,     ///< "5%"
  kLength,      ///< "0.3" scene units, or "5%" of the bounding-sphere radius
  kPosition,    ///< "1,2.5,-3"
  kDirection,   ///< "0,1,0" or "+Y"; not the zero vector
  kColor,       ///< "white", "#ff8000", "#f80" or three numbers from 0 to 1
  kRotation,    ///< nine numbers, or none
  kWindow,      ///< four numbers, or none
  kPair,        ///< two different numbers, or none
  kIntrinsics,  ///< one number or four, above 0, or none
  kAngles,      ///< two numbers, degrees: azimuth from -180 to 180 and elevation from -90 to 90
  kWords,       ///< "depth,normal"
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
  std::string_view field;   ///< name in APIs: "camera.zoom"
  std::string_view option;  ///< name on a command line, without dashes: "camera-zoom-factor"; empty: none
  std::string_view group, help;
  std::string_view initial;  ///< default as shown in help; empty: not shown
  OptionField where;         ///< empty: the option belongs to the command line or the process, not to Request
  unsigned commands = kRender;
  double min = 0.0, max = 0.0;  ///< inclusive range of numbers
  OptionForm form = OptionForm::kPlain;
  std::string_view unit = {};                          ///< unit of numbers: "deg", "px", "%", "scene units"
  std::vector<std::string_view> choices = {};          ///< all valid values; checked by set_option
  std::vector<std::string_view> (*names)() = nullptr;  ///< returns the valid names; checked by make_recipe
  std::string_view environment = {};  ///< environment variable that sets the default on the command line
};

/// Returns all rows, in the order of the help.
std::span<const Option> options();

/// Returns the row of a field, or null.
const Option* find_field(std::string_view field);

/// Returns the row of a field, which must exist.
const Option& option_of(std::string_view field);

/// Returns the row of an option of one of these commands, by its name without dashes, or null.
const Option* find_option(std::string_view name, unsigned commands);

/// Returns the message made printable (core/printable.h), with the options of a command line, --look, in place of
/// fields in backquotes, except inside
/// '...'.
std::string with_option_names(std::string_view message);

/// Returns the valid words of an option, from `choices` or `names`; empty if it takes other values.
std::vector<std::string_view> words_of(const Option& option);

/// Returns the valid range of a number.
Interval interval_of(const Option& option);

/// Sets a field from text; flags are set by "true" and "false". Errors: kUsage.
Result<void> set_option(const Option& option, std::string_view text, Request& request);

/// Resets a field to its default.
void reset_option(const Option& option, Request& request);

/// Checks the range and choices of one field. Errors: kUsage.
Result<void> check_option(const Option& option, Request& request);

/// Checks everything in a request that can be checked without the registries of looks and effects: ranges, choices and
/// contradictions, but not names. `max_pixels`: max number of pixels of the picture. Errors: kUsage.
Result<void> check_request(const Request& request, long max_pixels);

/// Returns what a message about a picture of more than `max_pixels` pixels adds: what can draw it.
std::string remedy_for_size(long max_pixels);

/// Splits a list at commas.
std::vector<std::string> split(std::string_view text);
/// Parses "640,480" or "640x480", or "512" for 512 x 512. `field`: its name in errors, also in the functions below.
/// Errors: kUsage.
Result<std::pair<int, int>> parse_size(std::string_view field, std::string_view text, long max_pixels);
/// Parses "0.3" or "5%", > 0. Errors: kUsage.
Result<Length> parse_length(std::string_view field, std::string_view text);
/// Parses "full", "half" or "quarter". Returns the downsampling factor: 1, 2 or 4. Errors: kUsage.
Result<int> parse_scale(std::string_view field, std::string_view text);

/// Limits of a picture. kMaxSide: width and height, pixels. kMaxPixels: pixels of all layers together that are in
/// memory at once; more need more memory than most machines have (64 million need at least 8 GB). kMaxStripPixels:
/// pixels of a picture that is drawn in strips (renderer/strips.h).
inline constexpr int kMaxSide = 16384;
inline constexpr long kMaxPixels = 8192L * 8192L;
inline constexpr long kMaxStripPixels = 2L * kMaxSide * kMaxSide;

}  // namespace umbrage
