#include "kit/fold.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <regex>
#include <vector>

#include "kit/kernel_items.h"

namespace umbrage {
namespace {

constexpr std::size_t kNone = std::string::npos;

/// Returns the text with comments replaced by spaces.
std::string blanked(std::string text) {
  for (std::size_t at = 0; (at = text.find("//", at)) != kNone;)
    for (; at < text.size() && text[at] != '\n'; ++at) text[at] = ' ';
  return text;
}

/// Returns the index of the bracket that closes the one at `open`.
std::size_t closing(const std::string& code, std::size_t open) {
  int depth = 0;
  for (std::size_t k = open; k < code.size(); ++k) {
    if (code[k] == '(' || code[k] == '{' || code[k] == '[') ++depth;
    if (code[k] == ')' || code[k] == '}' || code[k] == ']') --depth;
    if (depth == 0) return k;
  }
  return code.size() - 1;
}

std::size_t skip_space(const std::string& code, std::size_t at) {
  return std::min(code.find_first_not_of(" \n", at), code.size());
}

bool word_at(const std::string& code, std::size_t at, std::string_view word) {
  return code.compare(at, word.size(), word) == 0 &&
         (at + word.size() >= code.size() || !is_word(code[at + word.size()])) && (at == 0 || !is_word(code[at - 1]));
}

/// Returns the index behind the statement that begins at `at`, of an `if` with its `else`.
std::size_t statement_end(const std::string& code, std::size_t at) {
  at = skip_space(code, at);
  if (code[at] == '{') return closing(code, at) + 1;
  for (const std::string_view word : {"if", "for", "while"}) {
    if (!word_at(code, at, word)) continue;
    const std::size_t end = statement_end(code, closing(code, code.find('(', at)) + 1);
    const std::size_t next = skip_space(code, end);
    return word == "if" && word_at(code, next, "else") ? statement_end(code, next + 4) : end;
  }
  int depth = 0;
  for (; at < code.size(); ++at) {
    depth += code[at] == '(' ? 1 : code[at] == ')' ? -1 : 0;
    if (code[at] == ';' && depth == 0) break;
  }
  return at + 1;
}

std::vector<std::string> split_top(const std::string& text, std::string_view separator) {
  std::vector<std::string> parts;
  int depth = 0;
  std::size_t start = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    depth += text[k] == '(' || text[k] == '[' ? 1 : text[k] == ')' || text[k] == ']' ? -1 : 0;
    if (depth > 0 || text.compare(k, separator.size(), separator) != 0) continue;
    parts.push_back(text.substr(start, k - start));
    start = k + separator.size();
  }
  parts.push_back(text.substr(start));
  return parts;
}

std::string stripped(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \n"), end = text.find_last_not_of(" \n");
  return begin == kNone ? "" : text.substr(begin, end - begin + 1);
}

/// A condition that is decided, or what is left of it.
struct Condition {
  std::optional<bool> value;
  std::string text;
};

class Folder {
 public:
  explicit Folder(const KnownValues& known) : known_(known) {}

  std::string fold(std::string s) const {
    for (std::size_t at = 0; (at = next_if(s, at)) != kNone;) at = fold_if(s, at);
    return fold_choices(std::move(s));
  }

 private:
  static std::size_t next_if(const std::string& s, std::size_t at) {
    const std::string code = blanked(s);
    while ((at = code.find("if (", at)) != kNone && at > 0 && is_word(code[at - 1])) ++at;
    return at;
  }

  std::optional<double> number(const std::string& text) const {
    if (const auto found = known_.find(text); found != known_.end()) return found->second;
    if (text == "true" || text == "false") return text == "true";
    static const std::regex literal("-?[0-9]+(\\.[0-9]*)?(e-?[0-9]+)?");
    return std::regex_match(text, literal) ? std::optional(std::strtod(text.c_str(), nullptr)) : std::nullopt;
  }

  Condition evaluated(const std::string& whole) const {
    const std::string c = stripped(whole);
    for (const auto& [separator, absorbing] : {std::pair("||", true), std::pair("&&", false)}) {
      const auto parts = split_top(c, separator);
      if (parts.size() < 2) continue;
      std::string rest;
      int left = 0;
      for (const std::string& part : parts) {
        const Condition each = evaluated(part);
        if (each.value == absorbing) return {absorbing, {}};
        if (each.value) continue;
        rest += (left++ ? fmt::format(" {} ", separator) : "") + each.text;
      }
      return left == 0 ? Condition{!absorbing, {}} : Condition{std::nullopt, rest};
    }
    if (c.starts_with('(') && closing(c, 0) == c.size() - 1) {
      const Condition inner = evaluated(c.substr(1, c.size() - 2));
      return inner.value ? inner : Condition{std::nullopt, "(" + inner.text + ")"};
    }
    if (c.starts_with('!')) {
      const Condition inner = evaluated(c.substr(1));
      return inner.value ? Condition{!*inner.value, {}} : Condition{std::nullopt, c};
    }
    static const std::regex comparison("([A-Za-z0-9_.]+) (==|!=|<=|>=|<|>) (-?[A-Za-z0-9_.]+)");
    std::smatch match;
    if (std::regex_match(c, match, comparison)) {
      const auto a = number(match[1]), b = number(match[3]);
      const std::string op = match[2];
      if (a && b)
        return {op == "=="   ? *a == *b
                : op == "!=" ? *a != *b
                : op == "<=" ? *a <= *b
                : op == ">=" ? *a >= *b
                : op == "<"  ? *a < *b
                             : *a > *b,
                {}};
    }
    if (const auto found = known_.find(c); found != known_.end()) return {found->second != 0.0, {}};
    if (c == "true" || c == "false") return {c == "true", {}};
    return {std::nullopt, c};
  }

  /// Folds the `if` at `at`. Returns where to look for the next one.
  std::size_t fold_if(std::string& s, std::size_t at) const {
    const std::string code = blanked(s);
    const std::size_t open = code.find('(', at), close = closing(code, open), then_end = statement_end(code, close + 1);
    const Condition condition = evaluated(code.substr(open + 1, close - open - 1));
    if (!condition.value) {
      s.replace(open + 1, close - open - 1, condition.text);
      return open;
    }
    const std::size_t next = skip_space(code, then_end);
    const bool has_else = word_at(code, next, "else");
    const std::size_t end = has_else ? statement_end(code, next + 4) : then_end;
    std::string taken = stripped(*condition.value ? s.substr(close + 1, then_end - close - 1)
                                 : has_else       ? s.substr(next + 4, end - next - 4)
                                                  : "");
    const std::size_t line = s.rfind('\n', at) + 1;
    const bool is_statement = s.find_first_not_of(' ', line) == at;  // not behind `else` or the head of a loop
    if (!is_statement) {
      const std::size_t before = s.find_last_not_of(' ', at - 1);
      const bool after_else = before >= 3 && word_at(s, before - 3, "else");
      if (taken.empty() && after_else) {
        const std::size_t gap = s.find_last_not_of(" \n", before - 4);
        s.erase(gap + 1, end - gap - 1);
        return gap;
      }
      s.replace(at, end - at, taken.empty() ? "{}" : taken);
      return at;
    }
    if (taken.empty()) {
      const std::size_t begin = line > 0 ? line - 1 : line;
      std::size_t behind = end;  // with a comment behind the statement
      if (const std::size_t stop = std::min(s.find('\n', end), s.size());
          stripped(code.substr(end, stop - end)).empty())
        behind = stop;
      s.erase(begin, behind - begin);
      return begin;
    }
    const std::string indent(at - line, ' ');
    if (taken.starts_with('{') && !declares(taken)) taken = opened(taken, indent);
    const bool returns = ends_with_return(taken);
    std::size_t rest = end;
    if (returns) {  // what follows in the block is never reached
      int depth = 0;
      for (rest = end; rest < code.size() && depth >= 0; ++rest)
        depth += code[rest] == '{' ? 1 : code[rest] == '}' ? -1 : 0;
      --rest;
      rest = s.rfind('\n', rest);
      if (rest == kNone || rest < end) rest = end;
      if (taken.starts_with('{')) taken = opened(taken, indent);
    }
    s.replace(at, rest - at, taken);
    return at;
  }

  /// Whether a block declares variables, which could clash with others without its braces.
  static bool declares(const std::string& block) {
    static const std::regex declaration("\\n *(const )?(float|int|uint|bool|vec[23]|[A-Z][A-Za-z]+) [a-z_0-9]+( =|;)");
    return std::regex_search(block, declaration);
  }

  static bool ends_with_return(const std::string& taken) {
    std::string code = stripped(blanked(taken));
    while (code.ends_with('}')) code = stripped(code.substr(0, code.size() - 1));
    const std::size_t begin = code.find_last_of(";{}", code.size() < 2 ? 0 : code.size() - 2);
    const std::string last = stripped(begin == kNone ? code : code.substr(begin + 1));
    return word_at(last, 0, "return") &&
           (!taken.starts_with('{') || code.find("if (") == kNone || last.starts_with("return"));
  }

  /// Returns the statements of a block, indented as the block is.
  static std::string opened(const std::string& block, const std::string& indent) {
    std::string inner = block.substr(1, block.size() - 2), out;
    for (std::size_t begin = inner.find('\n'); begin != kNone && begin + 1 < inner.size();) {
      const std::size_t end = std::min(inner.find('\n', begin + 1), inner.size());
      const std::string line = inner.substr(begin + 1, end - begin - 1);
      if (!stripped(line).empty())
        out += (out.empty() ? "" : "\n") + (out.empty()              ? stripped(line)
                                            : line.starts_with("  ") ? line.substr(2)
                                                                     : line);
      begin = end < inner.size() ? end : kNone;
    }
    (void)indent;
    return out.empty() ? stripped(inner) : out;
  }

  /// Replaces `a ? b : c` with a known name or comparison a.
  std::string fold_choices(std::string s) const {
    static const std::regex choice("([A-Za-z0-9_.]+( (==|!=|>|<) [A-Za-z0-9_.]+)?) \\? ");
    for (std::size_t from = 0;;) {
      const std::string code = blanked(s);
      std::smatch match;
      const std::string tail = code.substr(from);
      if (!std::regex_search(tail, match, choice)) return s;
      const std::size_t at = from + std::size_t(match.position(0)), first = at + std::size_t(match.length(0));
      const Condition condition = evaluated(match[1]);
      const bool is_operand =
          at > 1 && code.substr(0, at).find_last_not_of(" \n") != kNone &&
          std::string("+-*/<>=!&|").find(code[code.substr(0, at).find_last_not_of(" \n")]) != kNone &&
          code[code.substr(0, at).find_last_not_of(" \n")] != '=';
      from = first;
      if (!condition.value || is_operand) continue;
      int depth = 0;
      std::size_t colon = kNone, end = first;
      for (; end < code.size(); ++end) {
        const char c = code[end];
        if (depth == 0 && (c == ',' || c == ';' || c == ')')) break;
        depth += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
        if (depth == 0 && c == ':' && colon == kNone) colon = end;
      }
      if (colon == kNone || code.substr(first, colon - first).find('?') != kNone) continue;
      s = s.substr(0, at) +
          stripped(*condition.value ? s.substr(first, colon - first) : s.substr(colon + 1, end - colon - 1)) +
          s.substr(end);
      from = at;
    }
  }

  const KnownValues& known_;
};

}  // namespace

std::string folded(std::string function, const KnownValues& known) { return Folder(known).fold(std::move(function)); }

}  // namespace umbrage
