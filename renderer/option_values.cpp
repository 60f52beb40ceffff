// Parses and checks the values of options.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <tuple>

#include "core/color.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "renderer/options.h"

namespace umbrage {
namespace {

constexpr std::string_view kValidLength = "a length above 0 in scene units, or a percentage such as 5%";
constexpr double kMaxPosition = 1e15;  // scene units; as for models: Embree cannot trace rays beyond

/// Parses `count` numbers separated by commas.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count) {
  std::vector<double> v(count);
  std::size_t start = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t end = i + 1 == count ? text.size() : text.find(',', start);
    if (end == std::string_view::npos) return std::nullopt;
    const auto value = parse_number(text.substr(start, end - start));
    if (!value) return std::nullopt;
    v[i] = *value;
    start = end + 1;
  }
  return v;
}

template <class T>
std::optional<std::array<T, 3>> parse_three(std::string_view text) {
  const auto v = parse_numbers(text, 3);
  return v ? std::optional(std::array<T, 3>{T((*v)[0]), T((*v)[1]), T((*v)[2])}) : std::nullopt;
}

/// Returns how many numbers a value of this form has; for kIntrinsics it may be one.
std::size_t count_of(OptionForm form) {
  return form == OptionForm::kRotation ? 9 : form == OptionForm::kWindow || form == OptionForm::kIntrinsics ? 4 : 2;
}

bool is_valid_list(OptionForm form, const std::vector<float>& v) {
  if (v.empty()) return true;  // not set
  if (form == OptionForm::kIntrinsics)
    return (v.size() == 1 || v.size() == 4) && std::all_of(v.begin(), v.end(), [](float x) { return x > 0.0f; });
  if (v.size() != count_of(form)) return false;
  if (form == OptionForm::kPair) return v[0] != v[1];
  return form != OptionForm::kAngles || (std::abs(v[0]) <= 180.0f && std::abs(v[1]) <= 90.0f);
}

template <class T>
bool is_zero(const std::array<T, 3>& v) {
  return v[0] == T(0) && v[1] == T(0) && v[2] == T(0);
}

/// Returns whether a vector is a valid value of this form.
template <class T>
bool is_valid_vector(OptionForm form, const std::array<T, 3>& v) {
  const auto all = [&](auto is_valid) { return std::all_of(v.begin(), v.end(), is_valid); };
  if (form == OptionForm::kColor) return all([](T x) { return x >= T(0) && x <= T(1); });
  return all([](T x) { return std::abs(x) <= kMaxPosition; }) && (form != OptionForm::kDirection || !is_zero(v));
}

/// Returns a description of the valid values.
std::string valid_values(const Option& o) {
  if (!o.choices.empty()) return joined_by_or(o.choices);
  switch (o.form) {
    case OptionForm::kLength:
      return std::string(kValidLength);
    case OptionForm::kPercent:
      return fmt::format("{:g}% to {:g}% of the picture's longer side", o.min, o.max);
    case OptionForm::kPosition:
      return fmt::format("three numbers up to {:g}, such as 1,2.5,-3", kMaxPosition);
    case OptionForm::kDirection:
      return "+X, -X, +Y, -Y, +Z, -Z or three numbers that are not all 0";
    case OptionForm::kColor:
      return "a CSS name such as white, #rrggbb, #rgb, or three numbers from 0 to 1 such as 0.2,0.3,0.5";
    case OptionForm::kAngles:
      return "two numbers: azimuth from -180 to 180 and elevation from -90 to 90";
    case OptionForm::kPair:
      return "two different numbers, such as 0.5,20";
    case OptionForm::kIntrinsics:
      return "one number above 0, or four: fx,fy,cx,cy";
    case OptionForm::kRotation:
    case OptionForm::kWindow:
      return fmt::format("{} numbers", count_of(o.form));
    default:
      break;
  }
  return interval_of(o).words();
}

template <class T>
Error refusal(const Option& o, const T& value) {
  return field_error(o.field, value, "`{}` cannot be '{}': it takes {}", valid_values(o));
}

/// Returns the error for a colour, with the nearest name if the text is a word.
Error color_error(const Option& o, std::string_view text) {
  if (text == "transparent" && o.field == "background")
    return field_error(o.field, text, "`{}` cannot be '{}': `transparent` draws no background");
  const bool is_word = !text.empty() && std::isalpha(static_cast<unsigned char>(text[0]));
  return field_error(o.field, text, "`{}` cannot be '{}': it takes {}{}", valid_values(o),
                     is_word ? did_you_mean(nearest_name(text, color_names())) : "");
}

Result<void> check_choice(const Option& o, std::string_view text) {
  const bool known = contains(o.choices, text);
  return o.choices.empty() || known ? Result<void>() : refusal(o, text);
}

/// Checks the value of an option in a request. Errors: kUsage.
class CheckValue {
 public:
  CheckValue(const Option& option, Request& request) : o_(option), request_(request) {}

  Result<void> operator()(std::monostate) { return {}; }
  Result<void> operator()(FieldOf<bool>) { return {}; }
  Result<void> operator()(FieldOf<std::vector<std::string>> of) {
    for (const std::string& word : of(request_))
      if (auto status = check_choice(o_, word); !status) return status;
    return {};
  }
  Result<void> operator()(FieldOf<std::vector<float>> of) {
    const std::vector<float>& values = of(request_);
    if (is_valid_list(o_.form, values)) return {};
    return refusal(o_, o_.form == OptionForm::kAngles ? fmt::format("{}", fmt::join(values, ","))
                                                      : fmt::format("{} numbers", values.size()));
  }
  Result<void> operator()(FieldOf<int> of) { return check_number(of(request_)); }
  Result<void> operator()(FieldOf<float> of) { return check_number(of(request_)); }
  Result<void> operator()(FieldOf<std::optional<int>> of) {
    return of(request_) ? check_number(*of(request_)) : Result<void>();
  }
  Result<void> operator()(FieldOf<std::optional<float>> of) {
    return of(request_) ? check_number(*of(request_)) : Result<void>();
  }
  Result<void> operator()(FieldOf<std::string> of) {
    const std::string& text = of(request_);
    Request defaults;
    if (text.empty() && of(defaults).empty()) return {};
    if (o_.form == OptionForm::kLength) {
      const auto length = parse_length(o_.field, text);
      return length ? Result<void>() : length.error();
    }
    return check_choice(o_, text);
  }
  Result<void> operator()(FieldOf<std::optional<Vector3>> of) { return check_vector(of(request_)); }
  Result<void> operator()(FieldOf<std::optional<Position>> of) { return check_vector(of(request_)); }

 private:
  template <class T>
  Result<void> check_vector(const std::optional<std::array<T, 3>>& v) {
    if (!v || is_valid_vector(o_.form, *v)) return {};
    return refusal(o_, fmt::format("{},{},{}", (*v)[0], (*v)[1], (*v)[2]));
  }
  Result<void> check_number(double value) { return interval_of(o_).has(value) ? Result<void>() : refusal(o_, value); }

  const Option& o_;
  Request& request_;
};

/// Sets an option's field from text. Errors: kUsage.
class SetValue {
 public:
  SetValue(const Option& option, std::string_view text, Request& request)
      : o_(option), text_(text), request_(request) {}

  Result<void> operator()(std::monostate) { return check_choice(o_, text_); }
  Result<void> operator()(FieldOf<bool> of) {
    if (text_ != "true" && text_ != "false")
      return field_error(o_.field, text_, "`{}` cannot be '{}': it takes true or false");
    of(request_) = text_ == "true";
    return {};
  }
  Result<void> operator()(FieldOf<std::vector<std::string>> of) {
    if (o_.form == OptionForm::kWords)
      of(request_) = split(text_);
    else
      of(request_).emplace_back(text_);
    return CheckValue(o_, request_)(of);
  }
  Result<void> operator()(FieldOf<std::vector<float>> of) {
    const bool is_one = o_.form == OptionForm::kIntrinsics && text_.find(',') == std::string_view::npos;
    const auto values = parse_numbers(text_, is_one ? 1 : count_of(o_.form));
    const std::vector<float> floats =
        values ? std::vector<float>(values->begin(), values->end()) : std::vector<float>();
    if (!values || !is_valid_list(o_.form, floats)) return refusal(o_, text_);
    of(request_) = floats;
    return {};
  }
  Result<void> operator()(FieldOf<std::string> of) {
    of(request_) = text_;
    return CheckValue(o_, request_)(of);
  }
  Result<void> operator()(FieldOf<int> of) { return set_integer(of(request_)); }
  Result<void> operator()(FieldOf<std::optional<int>> of) { return set_integer(of(request_)); }
  Result<void> operator()(FieldOf<float> of) { return set_number(of(request_)); }
  Result<void> operator()(FieldOf<std::optional<float>> of) { return set_number(of(request_)); }
  Result<void> operator()(FieldOf<std::optional<Vector3>> of) {
    const auto v = vector();
    if (!v || !is_valid_vector(o_.form, *v))
      return o_.form == OptionForm::kColor ? color_error(o_, text_) : refusal(o_, text_);
    of(request_) = v;
    return {};
  }
  Result<void> operator()(FieldOf<std::optional<Position>> of) {
    const auto v = parse_three<double>(text_);
    if (!v || !is_valid_vector(o_.form, *v)) return refusal(o_, text_);
    of(request_) = v;
    return {};
  }

 private:
  Result<void> set_integer(auto& to) {
    const auto value = parse_number(text_, interval_of(o_));
    if (!value) return refusal(o_, text_);
    to = int(*value);
    return {};
  }
  Result<void> set_number(auto& to) {
    const bool percent = o_.form == OptionForm::kPercent;
    const std::string_view digits = text_.substr(0, text_.size() - (percent && text_.ends_with('%') ? 1 : 0));
    const auto value = parse_number(digits, interval_of(o_));
    if (!value || percent != text_.ends_with('%')) return refusal(o_, text_);
    to = float(*value);
    return {};
  }
  std::optional<Vector3> vector() const {
    const bool is_signed = text_.starts_with('+') || text_.starts_with('-');
    const bool is_axis = o_.form == OptionForm::kDirection && text_.size() == 1 + std::size_t(is_signed);
    if (o_.form == OptionForm::kColor)
      if (const auto color = named_color(text_)) return color;
    if (!is_axis) return parse_three<float>(text_);
    const int index = (text_.back() | 0x20) - 'x';  // lower case
    if (index < 0 || index > 2) return std::nullopt;
    Vector3 v{};
    v[std::size_t(index)] = text_[0] == '-' ? -1.0f : 1.0f;
    return v;
  }

  const Option& o_;
  std::string_view text_;
  Request& request_;
};

/// Returns the error for two fields that contradict each other.
Error conflict(std::string_view field, std::string_view other, std::string_view text) {
  return with_field(field_error(field, "", "`{0}` and `{2}` {3}", other, text), other);
}

/// Checks that options do not contradict each other. Errors: kUsage.
Result<void> check_combinations(const Request& r) {
  const CameraSettings& camera = r.camera;
  if (camera.index && (camera.position || camera.focal_point || camera.direction)) {
    const char* other = camera.position      ? "camera.position"
                        : camera.focal_point ? "camera.focal_point"
                                             : "camera.direction";
    return conflict("camera.index", other, "both set the position of the camera: give one of them");
  }
  if (camera.position && camera.focal_point && camera.direction)
    return conflict("camera.focal_point", "camera.direction",
                    "both set the direction of a camera at `camera.position`: give one of them");
  if (camera.position && camera.focal_point && *camera.position == *camera.focal_point) {
    const Position& v = *camera.position;
    return conflict("camera.position", "camera.focal_point",
                    fmt::format("are both '{},{},{}': a camera cannot look at its own position", v[0], v[1], v[2]));
  }
  if (r.color && r.material == "file")
    return with_field(field_error("color", "", "`{}` needs `material` clay: the colours of the file are its own"),
                      "material", r.material);
  if (!r.color_by.empty() && (r.color || r.material == "clay"))
    return conflict("color_by", r.color ? "color" : "material",
                    r.color ? "both give the model its colour: give one of them"
                            : "clay: both give the model its colour; leave out `material`");
  if (r.hdri_skybox && r.hdri_file.empty())
    return field_error("hdri_skybox", true, "`{}` needs an image: `hdri_file` FILE, or `hdri_file` sky:");
  if (r.hdri_skybox && r.transparent)
    return conflict("hdri_skybox", "transparent", "both set the background: give one of them");
  return {};
}

}  // namespace

Interval interval_of(const Option& option) {
  const bool whole = std::holds_alternative<FieldOf<int>>(option.where) ||
                     std::holds_alternative<FieldOf<std::optional<int>>>(option.where);
  return {.min = option.min, .max = option.max, .kind = whole ? NumberKind::kInteger : NumberKind::kReal};
}

Result<void> set_option(const Option& option, std::string_view text, Request& request) {
  if (option.form == OptionForm::kSize) {
    const auto size = parse_size(option.field, text, kMaxStripPixels);
    if (!size) return size.error();
    std::tie(request.width, request.height) = *size;
    return {};
  }
  return std::visit(SetValue(option, text, request), option.where);
}

void reset_option(const Option& option, Request& request) {
  Request defaults;
  const auto reset = [&](auto of) {
    if constexpr (!std::is_same_v<decltype(of), std::monostate>) of(request) = of(defaults);
  };
  std::visit(reset, option.where);
}

Result<void> check_option(const Option& option, Request& request) {
  return std::visit(CheckValue(option, request), option.where);
}

Result<void> check_request(const Request& request, long max_pixels) {
  // Field accessors need a mutable request; it is only read here.
  auto& fields = const_cast<Request&>(request);
  for (const Option& option : options())
    if (auto status = std::visit(CheckValue(option, fields), option.where); !status) return status;
  if (long(request.width) * request.height > max_pixels)
    return field_error("width", request.width,
                       "a picture cannot have {1} x {2} pixels: it takes at most {3} in total{4}", request.height,
                       max_pixels, remedy_for_size(max_pixels));
  return check_combinations(request);
}

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> names;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    names.emplace_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  return names;
}

std::string remedy_for_size(long max_pixels) {
  if (max_pixels >= kMaxStripPixels) return "";
  return fmt::format("; umbrage render draws up to {}, in strips", kMaxStripPixels);
}

Result<std::pair<int, int>> parse_size(std::string_view field, std::string_view text, long max_pixels) {
  const std::size_t separator = text.find_first_of(",x");
  const auto parse_side = [&](std::string_view number) {
    int pixels = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), pixels);
    return error == std::errc() && end == number.data() + number.size() && pixels <= kMaxSide ? pixels : 0;
  };
  const int width = parse_side(text.substr(0, separator)),
            height = separator == std::string_view::npos ? width : parse_side(text.substr(separator + 1));
  if (width >= 1 && height >= 1 && long(width) * height <= max_pixels) return std::pair(width, height);
  return field_error(
      field, text,
      "`{}` cannot be '{}': it takes width,height from 1 to {} pixels, at most {} in total, or one number for a square",
      kMaxSide, std::min(max_pixels, long(kMaxSide) * kMaxSide));
}

Result<Length> parse_length(std::string_view field, std::string_view text) {
  const bool percent = text.ends_with('%');
  const float value = float(parse_number(text.substr(0, text.size() - (percent ? 1 : 0))).value_or(0.0));
  if (!(value > 0.0f) || !std::isfinite(value))
    return field_error(field, text, "`{}` cannot be '{}': it takes {}", kValidLength);
  return Length{value, percent ? 1 : 0};
}

Result<int> parse_scale(std::string_view field, std::string_view text) {
  const Option& option = option_of(field);
  for (std::size_t k = 0; k < option.choices.size(); ++k)
    if (option.choices[k] == text) return 1 << k;
  return refusal(option, text);
}

}  // namespace umbrage
