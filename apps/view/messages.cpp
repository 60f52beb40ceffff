#include "apps/view/messages.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "renderer/options.h"

namespace umbrage::view {
namespace {

using Json = nlohmann::json;

constexpr int kMaxDepth = 8;                                         // a state needs 5
constexpr std::int64_t kMaxNumber = std::int64_t(1) << 53;           // integers that JavaScript holds exactly
constexpr std::int64_t kMaxModel = std::numeric_limits<int>::max();  // ids of models are ints
constexpr std::size_t kMaxNameLength = 64;                           // of options and passes
constexpr std::size_t kMaxFileLength = 512;                          // "DROP/NAME", 32 + 1 + 255 bytes at most

/// Returns whether a text can be a name: 1 to kMaxNameLength of a-z, A-Z, 0-9 and `.`, `_`, `-`, not first a `-`.
bool is_name(std::string_view text) {
  constexpr std::string_view kCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  return !text.empty() && text.size() <= kMaxNameLength && text[0] != '-' &&
         text.find_first_not_of(kCharacters) == std::string_view::npos;
}

/// Parses an object. Errors: kUsage.
Result<Json> parse_object(std::string_view text) {
  if (text.size() > kMaxMessageBytes)
    return usage_error("a message has {} bytes; the max is {}", text.size(), kMaxMessageBytes);
  bool too_deep = false;
  const auto check_depth = [&](int depth, Json::parse_event_t, const Json&) {
    too_deep |= depth > kMaxDepth;
    return !too_deep;
  };
  Json value = Json::parse(text, check_depth, false);
  if (too_deep) return usage_error("a message is nested more than {} deep", kMaxDepth);
  if (value.is_discarded()) return usage_error("a message is not valid JSON");
  if (!value.is_object()) return usage_error("a message must be a JSON object");
  return value;
}

/// Reads the fields of an object. The first error is kept, and later calls return defaults.
class Fields {
 public:
  explicit Fields(const Json& object) : object_(object) {}

  std::int64_t integer(const char* name, std::int64_t min, std::int64_t max) {
    const Json* value = find(name);
    return value ? integer_of(*value, name, min, max) : min;
  }

  std::int64_t integer_of(const Json& value, std::string_view name, std::int64_t min, std::int64_t max) {
    // Unsigned values that an int64 cannot hold are above every max.
    const bool fits =
        value.is_number_integer() && (!value.is_number_unsigned() || value.get<std::uint64_t>() <= std::uint64_t(max));
    if (fits && value.get<std::int64_t>() >= min && value.get<std::int64_t>() <= max) return value.get<std::int64_t>();
    fail(usage_error("the {} of a message must be an integer from {} to {}", name, min, max));
    return min;
  }

  /// Returns a pair of numbers.
  std::pair<double, double> numbers(const char* name, double min, double max) {
    const Json* value = find(name);
    if (!value) return {min, min};
    const auto fits = [&](const Json& number) {
      return number.is_number() && number.get<double>() >= min && number.get<double>() <= max;
    };
    if (value->is_array() && value->size() == 2 && fits((*value)[0]) && fits((*value)[1]))
      return {(*value)[0].get<double>(), (*value)[1].get<double>()};
    fail(usage_error("the {} of a message must be two numbers from {} to {}", name, min, max));
    return {min, min};
  }

  bool flag(const char* name) {
    const auto at = object_.find(name);
    if (at == object_.end()) return false;
    if (at->is_boolean()) return at->get<bool>();
    fail(usage_error("the {} of a message must be true or false", name));
    return false;
  }

  std::string text(const char* name, std::size_t max_length) {
    const Json* value = find(name);
    if (!value) return {};
    if (value->is_string() && value->get_ref<const std::string&>().size() <= max_length &&
        !has_control(value->get_ref<const std::string&>()))
      return value->get<std::string>();
    fail(usage_error("the {} of a message must be a text of up to {} bytes in one line", name, max_length));
    return {};
  }

  /// Returns a text that is a name, or `missing`.
  std::string name(const char* name, std::string missing) {
    const auto at = object_.find(name);
    if (at == object_.end()) return missing;
    if (at->is_string() && is_name(at->get_ref<const std::string&>())) return at->get<std::string>();
    fail(usage_error("the {} of a message must be a name", name));
    return missing;
  }

  ViewOptions options() {
    const Json* value = find("options");
    if (!value) return {};
    if (!value->is_object()) {
      fail(usage_error("the options of a message must be an object"));
      return {};
    }
    ViewOptions options;
    for (const auto& [option, texts] : value->items()) {
      if (!is_name(option)) {
        fail(usage_error("an option of a message has a name that no option has"));
        return {};
      }
      const auto add = [&, &name = option](const Json& text) {
        if (text.is_string() && !has_control(text.get_ref<const std::string&>()))
          options[name].push_back(text.get<std::string>());
        else
          fail(usage_error("--{} of a message must be a text in one line or a list of such texts", name));
      };
      if (!texts.is_array())
        add(texts);
      else
        for (const Json& text : texts) add(text);
    }
    return options;
  }

  const Json* find(const char* name) {
    const auto at = object_.find(name);
    if (at != object_.end()) return &*at;
    fail(usage_error("a message lacks its {}", name));
    return nullptr;
  }

  void fail(Error error) {
    if (!error_) error_ = std::move(error);
  }
  const std::optional<Error>& error() const { return error_; }

 private:
  const Json& object_;
  std::optional<Error> error_;
};

Result<Message> parse_state(const Json& object) {
  Fields fields(object);
  State state;
  state.id = fields.integer("id", 0, kMaxNumber);
  state.moving = fields.flag("moving");
  state.model = int(fields.integer("model", 0, kMaxModel));
  if (const Json* size = fields.find("size")) {
    if (!size->is_array() || size->size() != 2) return usage_error("the size of a message must be two integers");
    state.width = int(fields.integer_of((*size)[0], "width", kMinViewSide, kMaxViewSide));
    state.height = int(fields.integer_of((*size)[1], "height", kMinViewSide, kMaxViewSide));
  }
  if (const Json* views = fields.find("views")) {
    if (!views->is_array() || views->empty() || views->size() > kMaxViews)
      return usage_error("the views of a message must be a list of one or two");
    for (const Json& view : *views) {
      if (!view.is_object()) return usage_error("a view of a message must be an object");
      Fields of_view(view);
      View& added = state.views.emplace_back();
      added.options = of_view.options();
      added.show = of_view.name("show", added.show);
      added.device = of_view.name("device", added.device);
      added.goes_on = of_view.flag("goes_on");
      if (of_view.error()) return *of_view.error();
    }
  }
  if (fields.error()) return *fields.error();
  return Message(std::move(state));
}

Result<Message> parse_open(const Json& object) {
  Fields fields(object);
  Open open{.file = fields.text("file", kMaxFileLength), .as = fields.name("as", "model")};
  if (fields.error()) return *fields.error();
  if (open.as != "model" && open.as != "environment" && open.as != "gbuffer")
    return usage_error("a file is opened as model, environment or gbuffer, not as '{}'", open.as);
  return Message(std::move(open));
}

Result<Message> parse_ack(const Json& object) {
  Fields fields(object);
  const Ack ack{fields.integer("frame", 0, kMaxNumber)};
  if (fields.error()) return *fields.error();
  return Message(ack);
}

Result<Message> parse_pick(const Json& object) {
  Fields fields(object);
  Pick pick{.id = fields.integer("id", 0, kMaxNumber)};
  std::tie(pick.x, pick.y) = fields.numbers("at", 0.0, 1.0);
  if (fields.error()) return *fields.error();
  return Message(pick);
}

}  // namespace

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

Result<Message> parse_message(std::string_view text) {
  const Result<Json> object = parse_object(text);
  if (!object) return object.error();
  const auto type = object->find("type");
  if (type == object->end() || !type->is_string()) return usage_error("a message lacks its type");
  if (*type == "state") return parse_state(*object);
  if (*type == "open") return parse_open(*object);
  if (*type == "ack") return parse_ack(*object);
  if (*type == "pick") return parse_pick(*object);
  return usage_error("the type of a message must be state, open, ack or pick");
}

Result<Save> parse_save(std::string_view text) {
  const Result<Json> object = parse_object(text);
  if (!object) return object.error();
  Fields fields(*object);
  Save save;
  save.options = fields.options();
  save.model = int(fields.integer("model", 0, kMaxModel));
  save.format = fields.text("format", kMaxNameLength);
  save.width = int(fields.integer("width", 1, kMaxSide));
  save.height = int(fields.integer("height", 1, kMaxSide));
  if (fields.error()) return *fields.error();
  for (const char* format : {"png", "exr", "svg", "jpg", "webp"})
    if (save.format == format) return save;
  return usage_error("the format of a message must be png, exr, svg, jpg or webp");
}

std::string text_of_json(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string error_text(std::string_view sentence, std::optional<std::int64_t> id, std::optional<int> view) {
  Json text = {{"type", "error"}, {"message", sentence}};
  if (id) text["id"] = *id;
  if (view) text["view"] = *view;
  return text_of_json(text);
}

std::string status_text(std::int64_t id, std::string_view sentence, std::optional<double> progress) {
  Json text = {{"type", "status"}, {"id", id}, {"text", sentence}};
  if (progress) text["progress"] = *progress;
  return text_of_json(text);
}

std::string environment_text(std::string_view file) { return text_of_json({{"type", "environment"}, {"file", file}}); }

std::string frame_bytes(const Json& header, std::string_view image) {
  const std::string text = text_of_json(header);
  std::string bytes;
  bytes.reserve(sizeof(std::uint32_t) + text.size() + image.size());
  for (int shift = 0; shift < 32; shift += 8) bytes += char(text.size() >> shift);
  return bytes.append(text).append(image);
}

int view_of_frame(std::string_view bytes) {
  std::uint32_t length = 0;
  if (bytes.size() < sizeof length) return 0;
  for (std::size_t i = 0; i < sizeof length; ++i)
    length |= std::uint32_t(static_cast<unsigned char>(bytes[i])) << 8 * i;
  const Json header = Json::parse(bytes.substr(sizeof length, length), nullptr, false);
  const auto view = header.is_object() ? header.find("view") : header.end();
  return view != header.end() && view->is_number_integer() ? view->get<int>() : 0;
}

}  // namespace umbrage::view
