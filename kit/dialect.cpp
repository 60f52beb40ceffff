#include "kit/dialect.h"

#include <algorithm>
#include <functional>
#include <regex>
#include <utility>
#include <vector>

#include "kit/text.h"

namespace umbrage {
namespace {

constexpr std::pair<std::string_view, std::string_view> kWords[] = {
    {"Real", "float"},          {"Int", "int"},
    {"Uint", "uint"},           {"Bool", "bool"},
    {"Vec2", "vec2"},           {"Vec3", "vec3"},
    {"CONST", "const"},         {"to_int", "int"},
    {"to_signed", "int"},       {"to_uint", "uint"},
    {"to_real", "float"},       {"bits_of", "floatBitsToUint"},
    {"rsqrt", "inversesqrt"},   {"real_of_bits", "uintBitsToFloat"},
    {"popcount", "count_bits"}, {"pow", "power"},
    {"mad", "mul_add"},  // `mad` is a function of HLSL
};

/// Replaces the calls of a function by what `by` returns of their arguments, inner ones first.
std::string with_calls(std::string text, std::string_view function,
                       const std::function<std::string(const std::vector<std::string>&)>& by) {
  for (std::size_t at = text.rfind(function); at != std::string::npos;
       at = at == 0 ? std::string::npos : text.rfind(function, at - 1)) {
    const std::size_t open = at + function.size();
    if ((at > 0 && is_word(text[at - 1])) || open >= text.size() || text[open] != '(') continue;
    const std::size_t end = closing(text, open);
    text.replace(at, end + 1 - at, by(split_outside(std::string_view(text).substr(open + 1, end - open - 1), ",")));
  }
  return text;
}

/// Removes conversions to a type around numbers, and around what has the type already.
std::string without_conversions(const std::string& text, const std::set<std::string>& floats) {
  static const std::regex integer("-?[0-9]+"), unsigned_integer("(0x[0-9a-f]+|[0-9]+)u"),
      real("-?[0-9]+\\.?[0-9]*(e-?[0-9]+)?f?"), indexed("(C\\.[a-z0-9_]+)\\[[^\\]]*\\]");
  const auto converted = [&](std::string_view type, const std::function<bool(const std::string&)>& has_type) {
    return [type = std::string(type), has_type](const std::vector<std::string>& words) {
      return words.size() == 1 && has_type(words[0]) ? words[0] : type + "(" + (words.empty() ? "" : words[0]) + ")";
    };
  };
  std::string out = with_calls(text, "int", converted("int", [](auto& a) { return std::regex_match(a, integer); }));
  out = with_calls(out, "uint", converted("uint", [](auto& a) { return std::regex_match(a, unsigned_integer); }));
  return with_calls(out, "float", converted("float", [&](const std::string& a) {
                      std::smatch match;
                      const std::string name = a.starts_with('-') ? a.substr(1) : a;
                      if (a.starts_with("float(") && closing(a, 5) == a.size() - 1) return true;
                      if (std::regex_match(a, real)) return a.find_first_of(".ef") != std::string::npos;
                      if (std::regex_match(name, match, indexed)) return floats.count(match[1]) > 0;
                      return floats.count(name) > 0;
                    }));
}

/// Aligns the lines within parentheses with the parenthesis, since shorter words before it have moved it.
std::string aligned(const std::string& text) {
  std::string out;
  std::vector<std::size_t> open;  // columns behind the parentheses that are open; 0: of a line that ends with one
  std::size_t column = 0, indent = 0;
  bool at_start = true, in_comment = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (at_start && c == ' ' && !open.empty()) continue;
    if (at_start && c != ' ') {
      if (!open.empty()) {
        column = open.back() > 0 ? open.back() : indent + 4;
        out.append(column, ' ');
      } else {
        indent = column;
      }
      at_start = false;
    }
    if (text.compare(k, 2, "//") == 0) in_comment = true;
    out += c;
    ++column;
    if (c == '\n') {
      column = 0;
      at_start = true;
      in_comment = false;
    }
    if (!in_comment && c == '(') open.push_back(text[k + 1] == '\n' ? 0 : column);
    if (!in_comment && c == ')' && !open.empty()) open.pop_back();
  }
  return out;
}

}  // namespace

std::string glsl_of(const std::string& item, const std::set<std::string>& floats) {
  // Comments are kept aside, so that nothing in them is taken for code.
  std::vector<std::string> comments;
  std::string code;
  for (std::size_t k = 0; k < item.size(); ++k) {
    if (item.compare(k, 2, "//") == 0) {
      const std::size_t end = std::min(item.find('\n', k), item.size());
      comments.push_back(item.substr(k, end - k));
      code += "//" + std::to_string(comments.size() - 1) + "!";
      k = end - 1;
      continue;
    }
    code += item[k];
  }
  for (const std::string_view mark : {"FN_RARE ", "FN "})
    if (code.starts_with(mark)) code = code.substr(mark.size());
  for (const auto& [word, by] : kWords) code = with_word(code, word, by);
  code = with_calls(code, "some", [](auto& a) { return "(" + a[0] + ")"; });
  code = with_calls(code, "entry_of", [](auto& a) { return a[0] + "[" + a[1] + "]"; });
  code = with_calls(code, "count_lanes", [](auto& a) { return "(" + a[0] + " ? 1 : 0)"; });
  code = with_calls(code, "this_lane", [](auto&) { return std::string("0"); });
  code = with_calls(code, "lane_value", [](auto& a) { return a[0]; });
  code = without_conversions(code, floats);
  static const std::regex suffix("\\b([0-9]+\\.?[0-9]*(e-?[0-9]+)?)f\\b"), doubled("\\(\\(([A-Za-z0-9_]+)\\)\\)"),
      negated("!\\(([A-Za-z0-9_]+)\\)");
  code = std::regex_replace(code, suffix, "$1");
  code = std::regex_replace(code, doubled, "($1)");
  code = std::regex_replace(code, negated, "!$1");
  code = aligned(code);
  std::string out;
  for (std::size_t k = 0; k < code.size(); ++k) {
    if (code.compare(k, 2, "//") == 0) {
      const std::size_t end = code.find('!', k);
      out += comments[std::size_t(std::stoi(code.substr(k + 2, end - k - 2)))];
      k = end;
      continue;
    }
    out += code[k];
  }
  return out;
}

}  // namespace umbrage
