// Names and values that calls pass: all names that the library lists, and unknown names and values.
#pragma once
#include <string>
#include <vector>

#include "call_memory.h"

namespace umbrage::fuzz {

/// A parameter as umbGetParameter lists it.
struct ListedParameter {
  std::string name, type;
  std::vector<std::string> choices;
  double min = 0.0, max = 0.0;
};

struct Words {
  std::vector<ListedParameter> parameters;  ///< parameters of jobs
  std::vector<std::string> effects, looks, scenes, passes;
  std::vector<std::string> files;  ///< of a G-buffer: one that holds a depth image, and ones that cannot be used
  std::vector<std::string> odd;    ///< unusual texts: not UTF-8, very long, format strings
};
const Words& words();

/// A temporary string, sometimes null.
class Text {
 public:
  Text() = default;
  Text(std::string text) : text_(std::move(text)), is_null_(false) {}
  const char* get() const { return is_null_ ? nullptr : text_.c_str(); }
  std::string shown() const;

 private:
  std::string text_;
  bool is_null_ = true;
};

Text any_odd(Choices& choose);
/// Returns the name of a pass, most of the time.
Text any_pass(Choices& choose);
/// Returns a parameter's value as text, most of the time in its range; numbers are small, since large ones take long.
std::string value_of(Choices& choose, const ListedParameter& parameter);
float any_number(Choices& choose);

}  // namespace umbrage::fuzz
