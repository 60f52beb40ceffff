#include "kit/fold.h"

#include <algorithm>
#include <cstdlib>
#include <regex>

#include "core/check.h"
#include "kit/text.h"

namespace umbrage {
namespace {

constexpr std::size_t kNone = std::string::npos;

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
  while (code[at] != ';') at = code[at] == '(' ? closing(code, at) : at + 1;
  return at + 1;
}

std::optional<double> number(const std::string& text, const KnownValues& known) {
  static const std::regex literal("-?[0-9]+(\\.[0-9]*)?(e-?[0-9]+)?");
  if (const auto found = known.find(text); found != known.end()) return found->second;
  if (text == "true" || text == "false") return text == "true";
  return std::regex_match(text, literal) ? std::optional(std::strtod(text.c_str(), nullptr)) : std::nullopt;
}

bool compared(double a, const std::string& sign, double b) {
  if (sign == "==") return a == b;
  if (sign == "!=") return a != b;
  if (sign == "<") return a < b;
  if (sign == ">") return a > b;
  return sign == "<=" ? a <= b : a >= b;
}

/// Whether a block declares variables, which could clash with others without its braces.
bool declares(const std::string& block) {
  static const std::regex declaration("\\n *(const )?(float|int|uint|bool|vec[23]|[A-Z][A-Za-z]+) [a-z_0-9]+( =|;)");
  return std::regex_search(block, declaration);
}

/// Whether a statement or block ends with a `return` that is always reached.
bool returns(const std::string& taken) {
  std::string code = stripped(blanked(taken));
  if (code.starts_with('{')) code = stripped(std::string_view(code).substr(1, code.size() - 2));
  if (!code.ends_with(';')) return false;
  const std::size_t before = code.find_last_of(";{}", code.size() - 2);
  return word_at(stripped(code.substr(before == kNone ? 0 : before + 1)), 0, "return");
}

/// Returns the statements of a block, indented as the block is.
std::string opened(const std::string& block) {
  return replaced(stripped(std::string_view(block).substr(1, block.size() - 2)), "\n  ", "\n");
}

/// Folds the `if` at `at`. Returns where to look for the next one.
std::size_t fold_if(std::string& s, std::size_t at, const KnownValues& known) {
  const std::string code = blanked(s);
  const std::size_t open = code.find('(', at), close = closing(code, open), then_end = statement_end(code, close + 1);
  const auto value = decided(code.substr(open + 1, close - open - 1), known);
  if (!value) return open;
  const std::size_t next = skip_space(code, then_end);
  const bool has_else = word_at(code, next, "else");
  std::size_t end = has_else ? statement_end(code, next + 4) : then_end;
  std::string taken = *value     ? stripped(s.substr(close + 1, then_end - close - 1))
                      : has_else ? stripped(s.substr(next + 4, end - next - 4))
                                 : "";
  const std::size_t before = at == 0 ? kNone : code.find_last_not_of(" \n", at - 1);
  if (before != kNone && code[before] == ')') fail_check("an `if` that is the body of a loop: " + s);
  if (before != kNone && before >= 3 && word_at(code, before - 3, "else")) {
    // Without a branch, the `else` goes too.
    const std::size_t begin = taken.empty() ? code.find_last_not_of(" \n", before - 4) + 1 : at;
    s.replace(begin, end - begin, taken);
    return begin;
  }
  if (taken.empty()) {  // the whole line, with a comment behind it
    const std::size_t line_end = std::min(s.find('\n', end), s.size());
    if (stripped(code.substr(end, line_end - end)).empty()) end = line_end;
    const std::size_t begin = s.rfind('\n', at);
    s.erase(begin, end - begin);
    return begin;
  }
  if (taken.starts_with('{') && (!declares(taken) || returns(taken))) taken = opened(taken);
  if (returns(taken)) {  // what follows in the block is never reached
    int depth = 0;
    for (; depth >= 0; ++end) depth += (code[end] == '{') - (code[end] == '}');
    end = s.rfind('\n', end - 1);
  }
  s.replace(at, end - at, taken);
  return at;
}

/// Folds `a ? b : c` with a known name or comparison a, if it begins an expression.
std::string fold_choices(std::string s, const KnownValues& known) {
  static const std::regex choice("([^!<>=]=|[(,]|return) ([A-Za-z0-9_.]+( (==|!=|>|<) [A-Za-z0-9_.]+)?) \\? ");
  for (std::size_t from = 0;;) {
    const std::string code = blanked(s), tail = code.substr(from);
    std::smatch match;
    if (!std::regex_search(tail, match, choice)) return s;
    const std::size_t at = from + std::size_t(match.position(2)),
                      first = from + std::size_t(match.position(0) + match.length(0));
    from = first;
    const auto value = decided(match[2], known);
    std::size_t end = first, colon = kNone;
    for (; std::string_view(",;)").find(code[end]) == kNone; ++end) {
      if (code[end] == '(' || code[end] == '[') end = closing(code, end);
      if (code[end] == ':' && colon == kNone) colon = end;
    }
    if (!value || colon == kNone || code.substr(first, colon - first).find('?') != kNone) continue;
    s.replace(at, end - at, stripped(*value ? s.substr(first, colon - first) : s.substr(colon + 1, end - colon - 1)));
    from = at;
  }
}

}  // namespace

std::optional<bool> decided(const std::string& condition, const KnownValues& known) {
  const std::string c = stripped(condition);
  for (const auto& [separator, absorbing] : {std::pair("||", true), std::pair("&&", false)}) {
    const auto parts = split_outside(c, separator);
    if (parts.size() < 2) continue;
    bool all = true;
    for (const std::string& part : parts) {
      const auto value = decided(part, known);
      if (value == absorbing) return value;
      all = all && value.has_value();
    }
    return all ? std::optional(!absorbing) : std::nullopt;
  }
  if (c.starts_with('(') && closing(c, 0) == c.size() - 1) return decided(c.substr(1, c.size() - 2), known);
  if (c.starts_with('!')) {
    const auto value = decided(c.substr(1), known);
    return value ? std::optional(!*value) : value;
  }
  static const std::regex comparison("([A-Za-z0-9_.]+) (==|!=|<=|>=|<|>) (-?[A-Za-z0-9_.]+)");
  std::smatch match;
  if (std::regex_match(c, match, comparison)) {
    const auto a = number(match[1], known), b = number(match[3], known);
    return a && b ? std::optional(compared(*a, match[2], *b)) : std::nullopt;
  }
  const auto value = number(c, known);
  return value ? std::optional(*value != 0.0) : std::nullopt;
}

std::string folded(std::string function, const KnownValues& known) {
  for (std::size_t at = 0;;) {
    const std::string code = blanked(function);
    while ((at = code.find("if (", at)) != kNone && at > 0 && is_word(code[at - 1])) ++at;
    if (at == kNone) return fold_choices(std::move(function), known);
    at = fold_if(function, at, known);
  }
}

}  // namespace umbrage
