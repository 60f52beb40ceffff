#include "kit/kernel_items.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <sstream>

#include "core/check.h"
#include "core/lists.h"
#include "kit/fold.h"
#include "kit/text.h"

namespace umbrage {
namespace {

constexpr std::string_view kCommon = "kernel/common.kernel.h", kFrame = "kernel/frame_constants.h",
                           kImages = "kernel/glsl_images.h";

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  std::istringstream stream{std::string(text)};
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string without_comment(std::string_view line) { return stripped(line.substr(0, line.find("//"))); }

using Macros = std::map<std::string, std::string>;

Macros macros_of(const KernelText& kernel) {
  Macros macros;
  for (const std::string& word : split_outside(kernel.macros, " "))
    if (const std::size_t at = word.find('='); at != std::string::npos)
      macros[word.substr(0, at)] = word.substr(at + 1);
  return macros;
}

/// The lines of a file and of those that it includes, without preprocessor lines.
class Assembler {
 public:
  explicit Assembler(Macros macros) : macros_(std::move(macros)) {}

  void add(std::string_view file) {
    if (!done_.insert(std::string(file)).second) return;
    bool in_macro = false;
    std::vector<bool> active = {true};
    for (std::string line : lines_of(source_text(file))) {
      const bool continues = line.ends_with('\\');
      if (in_macro || line.starts_with("#define")) {
        in_macro = continues;
        continue;
      }
      for (const auto& [name, value] : macros_) line = with_word(line, name, value);
      if (line.starts_with("#ifndef")) continue;  // the guard of a header, whose #endif removes nothing
      if (line.starts_with("#if ")) active.push_back(active.back() && decided(line.substr(4), {}) == true);
      if (line.starts_with("#else")) active.back() = !active.back() && active[active.size() - 2];
      if (line.starts_with("#endif") && active.size() > 1) active.pop_back();
      if (!active.back()) continue;
      if (line.starts_with("#include \"") && line.ends_with(".kernel.h\"")) add(line.substr(10, line.size() - 11));
      if (line.starts_with('#') || line.starts_with("// KERNEL ")) continue;
      lines.push_back(line);
    }
  }

  std::vector<std::string> lines;

 private:
  Macros macros_;
  std::set<std::string> done_;
};

/// Returns the names that an item declares: of a function, a struct or constants.
std::vector<std::string> names_of(const std::string& text) {
  std::vector<std::string> names;
  std::string code = without_comment(text.substr(0, text.find('\n')));
  for (const std::string_view prefix : {"FN_RARE ", "FN ", "CONST ", "const "})
    if (code.starts_with(prefix)) code = code.substr(prefix.size());
  if (text.starts_with("const ") || text.starts_with("CONST ")) {
    for (const std::string& part : split_outside(text, ","))
      if (const std::size_t equals = part.find('='); equals != std::string::npos) {
        const auto words = words_of(part.substr(0, equals));
        if (!words.empty()) names.push_back(words.back());
      }
    return names;
  }
  const auto words = words_of(code.substr(0, code.find_first_of("({;")));
  if (!words.empty()) names.push_back(words.back());
  return names;
}

/// Adds the planes of a declaration such as IN_REAL(depth), if it is one.
bool add_planes(const std::string& line, std::vector<KernelPlane>& planes) {
  using Kind = KernelPlane::Kind;
  const std::size_t open = line.find('('), close = line.find(')');
  if (open == std::string::npos || close == std::string::npos) return false;
  std::string macro = line.substr(0, open);
  if (!macro.starts_with("IN") && !macro.starts_with("OUT_") && !macro.starts_with("LIST_") && macro != "SUMS")
    return false;
  std::vector<std::string> names = split_outside(std::string_view(line).substr(open + 1, close - open - 1), ",");
  KernelPlane plane{.type = "float"};
  plane.kind = macro.starts_with("INOUT") ? Kind::kInOut : macro.starts_with("IN") ? Kind::kIn : Kind::kOut;
  if (macro == "SUMS" || macro.starts_with("LIST_")) {
    plane.kind = macro == "SUMS" ? Kind::kSums : Kind::kList;
    plane.type = macro == "LIST_UINT" ? "uint" : "float";
    if (names.size() > 1) plane.length = names[1];
    names.resize(1);
  }
  if (macro.find("VECTOR") != std::string::npos || macro.find("COLOR") != std::string::npos) plane.type = "vec3";
  if (macro.ends_with("_IF")) {
    if (names[0] == "0" && macro != "IN_REAL_AND_LAYERS_IF") plane.kind = Kind::kAbsent;
    names.erase(names.begin());
  }
  plane.local = names.front();
  plane.name = names.back();
  if (macro.ends_with("_ALPHA")) {
    plane.is_alpha = true;
    plane.name = plane.local = plane.name + "_a";
  }
  planes.push_back(plane);
  return true;
}

bool begins_item(const std::string& line) {
  for (const std::string_view prefix : {"FN ", "FN_RARE ", "CONST ", "const ", "struct "})
    if (line.starts_with(prefix)) return true;
  return false;
}

/// Whether a line begins a function or variable of glsl_images.h, which has no marks of the dialect.
bool begins_glsl(const std::string& line) {
  for (const std::string_view prefix : {"float ", "bool ", "int ", "uint ", "vec2 ", "vec3 ", "ivec2 "})
    if (line.starts_with(prefix)) return true;
  return false;
}

/// Whether the item in `text` ends with its last line `line`.
bool ends_item(const std::string& text, const std::string& line) {
  const std::string code = without_comment(line);
  const bool is_one_line = text.find('\n') == std::string::npos;
  if (text.starts_with("const ") || text.starts_with("CONST ")) return code.ends_with(';');
  return is_one_line ? code.ends_with('}') || code.ends_with(';') : line == "}" || line == "};";
}

KernelItems items_in(const std::vector<std::string>& lines) {
  KernelItems result;
  std::string comment;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const std::string& line = lines[k];
    if (line.starts_with("//")) {
      comment += line + "\n";
      continue;
    }
    if (add_planes(line, result.planes) || line.empty()) {
      comment.clear();
      continue;
    }
    if (!begins_item(line) && !begins_glsl(line)) fail_check("kernel text: " + line);
    std::string text = line;
    while (!ends_item(text, lines[k])) text += "\n" + lines[++k];
    const bool is_constants = text.starts_with("struct ") && names_of(text)[0].ends_with("Constants");
    const bool is_params = text.starts_with("struct ") && names_of(text)[0].ends_with("Params");
    if (!is_constants && !is_params) result.items.push_back({comment, text, names_of(text)});
    comment.clear();
  }
  return result;
}

/// Returns the value of a product of integers and names of constants.
int product_of(std::string_view header, std::string_view factors) {
  int product = 1;
  for (const std::string& factor : split_outside(factors, "*")) {
    int value = 0;
    const auto [end, error] = std::from_chars(factor.data(), factor.data() + factor.size(), value);
    product *= error == std::errc() ? value : integer_constant(header, factor);
  }
  return product;
}

}  // namespace

KernelItems kernel_items(const KernelText& kernel) {
  Assembler assembler(macros_of(kernel));
  for (const std::string_view file : {kFrame, kImages, kernel.header, kCommon, kernel.file}) assembler.add(file);
  KernelItems result = items_in(assembler.lines);
  for (const std::string& line : lines_of(source_text(kernel.file))) {
    if (!line.starts_with("//")) break;
    if (!line.starts_with("// KERNEL ")) result.about += line + "\n";
  }
  return result;
}

std::vector<ConstantField> constant_fields(std::string_view header, std::string_view name) {
  std::vector<ConstantField> fields;
  const std::string begin = fmt::format("struct {} {{", name);
  std::string before;
  bool inside = false;
  for (const std::string& line : lines_of(source_text(header))) {
    if (inside && line == "};") return fields;
    if (inside && stripped(line).starts_with("//")) before += (before.empty() ? "" : " ") + stripped(line).substr(3);
    const std::string code = without_comment(line);
    if (inside && code.ends_with(';')) {
      const std::size_t comment = line.find("// ");
      std::string about = comment == std::string::npos ? before : line.substr(comment + 3);
      before.clear();
      const std::string type = code.substr(0, code.find(' '));
      const auto names = split_outside(std::string_view(code).substr(type.size(), code.size() - type.size() - 1), ",");
      const auto parts = split_outside(about, ";");  // "scene units; relative to the distance": one part for each name
      for (std::size_t k = 0; k < names.size(); ++k) {
        const std::string& field = names[k];
        const std::size_t bracket = field.find('[');
        const bool is_array = bracket != std::string::npos;
        const int count = is_array ? product_of(header, field.substr(bracket + 1, field.size() - bracket - 2)) : 1;
        fields.push_back(
            {type, field.substr(0, bracket), count, is_array, parts.size() == names.size() ? parts[k] : about});
      }
    }
    if (line == begin) inside = true;
  }
  fail_check(fmt::format("{} has no struct {}", header, name));
}

int integer_constant(std::string_view header, std::string_view name) {
  for (const std::string_view file : {header, kFrame}) {
    const auto words = words_of(std::string(source_text(file)));
    for (std::size_t k = 0; k + 1 < words.size(); ++k) {
      int value = 0;
      const std::string& next = words[k + 1];
      if (words[k] == name && std::from_chars(next.data(), next.data() + next.size(), value).ec == std::errc())
        return value;
    }
  }
  fail_check(fmt::format("{} has no constant {}", header, name));
}

std::string plane_template(std::string_view name) {
  std::string body;
  bool inside = false;
  for (std::string line : lines_of(source_text(kImages))) {
    const bool continues = line.ends_with('\\');
    if (continues) line.pop_back();
    while (line.ends_with(' ')) line.pop_back();
    if (inside) body += (line.starts_with("  ") ? line.substr(2) : line) + "\n";
    if (inside && !continues) return body;
    if (line.starts_with(fmt::format("#define {}(", name))) inside = true;
  }
  fail_check(fmt::format("{} has no macro {}", kImages, name));
}

}  // namespace umbrage
