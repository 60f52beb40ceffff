// Parts of the PLY reader: the header, and the numbers that follow it.
#pragma once
#include <array>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "scene/readers/text_rules.h"
#include "scene/scene.h"

namespace umbrage::ply {

enum class Number { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

inline constexpr std::array<int, 8> kBytes{1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
  std::string name;
  Number number = Number::kFloat32;
  std::optional<Number> list_size;  ///< set for lists
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;

  /// Returns the index of a property that is not a list, or is one; -1 if there is none.
  int find(std::string_view property, bool list = false) const;
};

enum class Storage { kText, kLittle, kBig };

struct Header {
  Storage storage = Storage::kText;
  std::vector<Element> elements;
  std::vector<std::string> textures;  ///< names in comments "TextureFile NAME"
};

/// Reads the header and moves `text` past it. Errors: kFile.
Result<Header> read_header(std::string_view& text, const std::string& file);

/// A reader of the numbers after a header. After the end it returns zeros, and `ended` is set. In a text file with one
/// row of an element per line, as the format demands, a row that lacks a number, or has a word that is none, is marked
/// as bad, and reading goes on in the next line; in other text files such a word is the end. Lines that begin with
/// `comment`, `obj_info` or `#` are skipped.
class Body {
 public:
  /// `whole`: all of the file, for the numbers of lines. `body`: what follows the header.
  Body(std::string_view whole, std::string_view body, const Header& header);

  void begin_row();
  /// Returns a number; NaN, and the row is bad, for a word that is none.
  double next(Number number) { return storage_ == Storage::kText ? text() : binary(number); }
  /// Returns whether there may be more numbers of this row: false after the end and in a bad row.
  bool row_goes_on() const { return !ended_ && !row_is_bad_; }
  /// Returns whether the row is bad.
  bool end_row();

  bool ended() const { return ended_; }
  std::size_t left() const { return std::size_t(end_ - at_); }
  std::size_t bad_rows() const { return bad_rows_; }
  /// Returns the number of the line with the first bad row, from 1; 0: none.
  std::size_t first_bad_line() const { return first_bad_ ? line_number_at(whole_, first_bad_) : 0; }
  /// Returns the number of the line with the first decimal comma, from 1; 0: none.
  std::size_t comma_line() const { return comma_ ? line_number_at(whole_, comma_) : 0; }
  /// Forgets the bad rows so far.
  void forget_bad_rows() { bad_rows_ = 0; }

 private:
  void skip_blanks_and_comments();
  double text();
  double binary(Number number);
  template <class T>
  double binary_as();

  std::string_view whole_;
  const char* at_;
  const char* end_;
  const char* row_end_;
  const char* row_begin_;
  const char *first_bad_ = nullptr, *comma_ = nullptr;
  Storage storage_;
  bool row_per_line_ = false, row_is_bad_ = false, ended_ = false;
  std::size_t bad_rows_ = 0;
};

/// One Gaussian, with the values of its file.
struct Splat {
  glm::vec3 harmonics;  ///< coefficients of degree 0 of the colour's spherical harmonics
  float opacity;        ///< before the sigmoid
  glm::vec3 log_scale;  ///< logarithms of the standard deviations
  glm::vec4 rotation;   ///< quaternion: w, x, y, z
};

/// Replaces the only mesh of a scene, whose positions are the Gaussians' centres, by points with colours and radii:
/// discs along the two longer axes of flat Gaussians, spheres for others. Gaussians with an opacity below 0.3 are left
/// out. Adds a warning that says what is not drawn.
void draw_splats(const std::vector<Splat>& splats, Scene& scene);

}  // namespace umbrage::ply
