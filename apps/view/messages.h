// Messages between the page of `umbrage view` and the program: JSON texts, and frames. Only this file reads JSON that a
// page sent, so that everything behind it deals with checked values.
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/result.h"

namespace umbrage::view {

/// Limits of a message. Bytes of a text from a page; pixels of each side of a view; number of views.
inline constexpr std::size_t kMaxMessageBytes = 65536;
inline constexpr int kMinViewSide = 16, kMaxViewSide = 8192;
inline constexpr std::size_t kMaxViews = 2;

/// Options of the command line: name without dashes -> values; several only for a repeated option, such as `set`.
/// Values are not checked here: set_option of renderer/options.h does so.
using ViewOptions = std::map<std::string, std::vector<std::string>>;

/// What one view shows. `show`: "picture", "reference", "error" or the name of a pass. `goes_on`: the same as in the
/// state before, whose pictures the page has.
struct View {
  ViewOptions options;
  std::string show = "picture";
  std::string device;  ///< empty: the device of the program
  bool goes_on = false;
};

/// The state of a page: what it wants to see. `id` grows; `width`, `height`: device pixels of each view; `model`: its
/// id.
struct State {
  std::int64_t id = 0;
  bool moving = false;
  int width = 0, height = 0;
  int model = 0;
  std::vector<View> views;  ///< one or two
};

/// A request to open an uploaded file, "DROP/NAME", as "model", "environment" or "gbuffer".
struct Open {
  std::string file, as;
};

/// The page has shown this frame, and with it every frame of a lower number.
struct Ack {
  std::int64_t frame = 0;
};

/// Asks for the surface at a point of the first view of the page's state. `x`, `y`: from the upper left corner, from 0
/// to 1.
struct Pick {
  std::int64_t id = 0;  ///< of the state
  double x = 0.0, y = 0.0;
};

using Message = std::variant<State, Open, Ack, Pick>;

/// Returns whether a text has control characters.
bool has_control(std::string_view text);

/// Returns a page's message. Never throws; the depth of nesting is bounded. Errors: kUsage, one line.
Result<Message> parse_message(std::string_view text);

/// A picture to save. `format`: "png", "exr", "svg", "jpg" or "webp"; sizes are in pixels.
struct Save {
  ViewOptions options;
  int model = 0;
  std::string format;
  int width = 0, height = 0;
};

/// Returns the body of a request to save, as parse_message. Errors: kUsage, one line.
Result<Save> parse_save(std::string_view text);

/// Returns the text of an error: for a state and one of its views, if they are given.
std::string error_text(std::string_view sentence, std::optional<std::int64_t> id = {}, std::optional<int> view = {});

/// Returns the text of a status; `progress`: from 0 to 1, if it is known.
std::string status_text(std::int64_t id, std::string_view text, std::optional<double> progress = {});

/// Returns the text that answers the opening of an environment.
std::string environment_text(std::string_view file);

/// Returns a JSON value as text; bytes that are not UTF-8 are replaced.
std::string text_of_json(const nlohmann::json& value);

/// Returns the bytes of a binary message: the size of the header (32 bits, little-endian), the header, the image file.
std::string frame_bytes(const nlohmann::json& header, std::string_view image);

/// Returns the view of such a message, 0 if it names none.
int view_of_frame(std::string_view bytes);

}  // namespace umbrage::view
