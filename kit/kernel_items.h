// Reads the text of a kernel: what it declares, item by item, with its comments.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "kit/kernel_texts.h"

namespace umbrage {

/// A function, struct or line of constants of a kernel, in the kernel dialect.
struct KernelItem {
  std::string comment;             ///< the lines before it, each with a line feed
  std::string text;                ///< without the line feed at its end
  std::vector<std::string> names;  ///< that it declares
};

/// A plane, list or sum that a kernel declares.
struct KernelPlane {
  enum class Kind { kIn, kOut, kInOut, kList, kSums, kAbsent };
  Kind kind = Kind::kIn;
  std::string type;         ///< "float" or "vec3" (lists: "float" or "uint")
  std::string name;         ///< "ao", "color_a" for the alpha of `color`
  std::string local;        ///< what functions call it: near_LOCAL()
  std::string length = {};  ///< of a list
  bool is_alpha = false;    ///< it is the fourth channel of the plane without "_a"
};

/// A field of a struct of constants; 4 bytes, or an array of such.
struct ConstantField {
  std::string type, name;  ///< "int" or "float"
  int count = 1;           ///< of an array
  bool is_array = false;
  std::string about;  ///< the comment; may be empty
};

struct KernelItems {
  std::string about;  ///< the comment at the start of the kernel's file
  std::vector<KernelItem> items;
  std::vector<KernelPlane> planes;
};

/// Returns what a kernel declares, with its macros replaced and the parts that they exclude left out. The items of
/// glsl_images.h, of the headers of constants and of common.kernel.h are included.
KernelItems kernel_items(const KernelText& kernel);

/// Returns the fields of a struct of constants in a header, in order. Throws InternalError if it is not there.
std::vector<ConstantField> constant_fields(std::string_view header, std::string_view name);

/// Returns the value of an integer constant that a header declares: `const int kBitmaskRows = 65`.
int integer_constant(std::string_view header, std::string_view name);

/// Returns the body of a macro of glsl_images.h, with its line breaks: "IN_PLANE".
std::string plane_template(std::string_view name);

}  // namespace umbrage
