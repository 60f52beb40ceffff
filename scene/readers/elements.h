// Chemical elements: colours and radii of their atoms.
#pragma once
#include <glm/vec3.hpp>
#include <string_view>

namespace umbrage {

struct Element {
  glm::vec3 color;  ///< linear
  float radius;     ///< van der Waals radius, 1e-10 m
};

/// Returns the element that the one or two letters at the beginning of a word name, such as "C", "CL" or "Fe2+"; null
/// if there is none, or the word has more letters. "D" and "T" are hydrogen.
const Element* find_element(std::string_view word);

/// Returns the symbol of an atomic number; empty if there is none.
std::string_view symbol_of(unsigned atomic_number);

/// Returns the values for an atom of no known element.
const Element& unknown_element();

}  // namespace umbrage
