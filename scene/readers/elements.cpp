// Colours are those of Jmol (jmol.org, "Jmol colors"), radii those of [Alvarez 2013], table 1.
#include "scene/readers/elements.h"

#include <array>
#include <cctype>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>

#include "scene/readers/vertex_colors.h"

namespace umbrage {
namespace {

constexpr float kNoRadius = 2.0f;  // for elements without a measured radius

struct Row {
  const char* symbol;
  std::uint32_t rgb;  // sRGB
  float radius;
};

// clang-format off
constexpr Row kRows[] = {
    {"H", 0xffffff, 1.20f}, {"He", 0xd9ffff, 1.43f}, {"Li", 0xcc80ff, 2.12f}, {"Be", 0xc2ff00, 1.98f},
    {"B", 0xffb5b5, 1.91f}, {"C", 0x909090, 1.77f}, {"N", 0x3050f8, 1.66f}, {"O", 0xff0d0d, 1.50f},
    {"F", 0x90e050, 1.46f}, {"Ne", 0xb3e3f5, 1.58f}, {"Na", 0xab5cf2, 2.50f}, {"Mg", 0x8aff00, 2.51f},
    {"Al", 0xbfa6a6, 2.25f}, {"Si", 0xf0c8a0, 2.19f}, {"P", 0xff8000, 1.90f}, {"S", 0xffff30, 1.89f},
    {"Cl", 0x1ff01f, 1.82f}, {"Ar", 0x80d1e3, 1.83f}, {"K", 0x8f40d4, 2.73f}, {"Ca", 0x3dff00, 2.62f},
    {"Sc", 0xe6e6e6, 2.58f}, {"Ti", 0xbfc2c7, 2.46f}, {"V", 0xa6a6ab, 2.42f}, {"Cr", 0x8a99c7, 2.45f},
    {"Mn", 0x9c7ac7, 2.45f}, {"Fe", 0xe06633, 2.44f}, {"Co", 0xf090a0, 2.40f}, {"Ni", 0x50d050, 2.40f},
    {"Cu", 0xc88033, 2.38f}, {"Zn", 0x7d80b0, 2.39f}, {"Ga", 0xc28f8f, 2.32f}, {"Ge", 0x668f8f, 2.29f},
    {"As", 0xbd80e3, 1.88f}, {"Se", 0xffa100, 1.82f}, {"Br", 0xa62929, 1.86f}, {"Kr", 0x5cb8d1, 2.25f},
    {"Rb", 0x702eb0, 3.21f}, {"Sr", 0x00ff00, 2.84f}, {"Y", 0x94ffff, 2.75f}, {"Zr", 0x94e0e0, 2.52f},
    {"Nb", 0x73c2c9, 2.56f}, {"Mo", 0x54b5b5, 2.45f}, {"Tc", 0x3b9e9e, 2.44f}, {"Ru", 0x248f8f, 2.46f},
    {"Rh", 0x0a7d8c, 2.44f}, {"Pd", 0x006985, 2.15f}, {"Ag", 0xc0c0c0, 2.53f}, {"Cd", 0xffd98f, 2.49f},
    {"In", 0xa67573, 2.43f}, {"Sn", 0x668080, 2.42f}, {"Sb", 0x9e63b5, 2.47f}, {"Te", 0xd47a00, 1.99f},
    {"I", 0x940094, 2.04f}, {"Xe", 0x429eb0, 2.06f}, {"Cs", 0x57178f, 3.48f}, {"Ba", 0x00c900, 3.03f},
    {"La", 0x70d4ff, 2.98f}, {"Ce", 0xffffc7, 2.88f}, {"Pr", 0xd9ffc7, 2.92f}, {"Nd", 0xc7ffc7, 2.95f},
    {"Pm", 0xa3ffc7, kNoRadius}, {"Sm", 0x8fffc7, 2.90f}, {"Eu", 0x61ffc7, 2.87f}, {"Gd", 0x45ffc7, 2.83f},
    {"Tb", 0x30ffc7, 2.79f}, {"Dy", 0x1fffc7, 2.87f}, {"Ho", 0x00ff9c, 2.81f}, {"Er", 0x00e675, 2.83f},
    {"Tm", 0x00d452, 2.79f}, {"Yb", 0x00bf38, 2.80f}, {"Lu", 0x00ab24, 2.74f}, {"Hf", 0x4dc2ff, 2.63f},
    {"Ta", 0x4da6ff, 2.53f}, {"W", 0x2194d6, 2.57f}, {"Re", 0x267dab, 2.49f}, {"Os", 0x266696, 2.48f},
    {"Ir", 0x175487, 2.41f}, {"Pt", 0xd0d0e0, 2.29f}, {"Au", 0xffd123, 2.32f}, {"Hg", 0xb8b8d0, 2.45f},
    {"Tl", 0xa6544d, 2.47f}, {"Pb", 0x575961, 2.60f}, {"Bi", 0x9e4fb5, 2.54f}, {"Po", 0xab5c00, kNoRadius},
    {"At", 0x754f45, kNoRadius}, {"Rn", 0x428296, kNoRadius}, {"Fr", 0x420066, kNoRadius},
    {"Ra", 0x007d00, kNoRadius}, {"Ac", 0x70abfa, 2.80f}, {"Th", 0x00baff, 2.93f}, {"Pa", 0x00a1ff, 2.88f},
    {"U", 0x008fff, 2.71f}, {"Np", 0x0080ff, 2.82f}, {"Pu", 0x006bff, 2.81f}, {"Am", 0x545cf2, 2.83f},
    {"Cm", 0x785ce3, 3.05f}, {"Bk", 0x8a4fe3, 3.40f}, {"Cf", 0xa136d4, 3.05f}, {"Es", 0xb31fd4, 2.70f},
    {"Fm", 0xb31fba, kNoRadius}, {"Md", 0xb30da6, kNoRadius}, {"No", 0xbd0d87, kNoRadius},
    {"Lr", 0xc70066, kNoRadius}, {"Rf", 0xcc0059, kNoRadius}, {"Db", 0xd1004f, kNoRadius},
    {"Sg", 0xd90045, kNoRadius}, {"Bh", 0xe00038, kNoRadius}, {"Hs", 0xe6002e, kNoRadius},
    {"Mt", 0xeb0026, kNoRadius},
};
// clang-format on

/// Returns a reflectance. Jmol's colours are those of lit pixels; no surface reflects all of one colour and nothing of
/// the others, and pictures of such surfaces have no shades.
glm::vec3 reflectance(std::uint32_t rgb) {
  constexpr float kMin = 0.04f, kMax = 0.85f;
  const glm::vec3 color(float(rgb >> 16 & 255u), float(rgb >> 8 & 255u), float(rgb & 255u));
  return kMin + (kMax - kMin) * linear_color(color / 255.0f);
}

char upper(char c) { return char(std::toupper(static_cast<unsigned char>(c))); }

/// Returns all elements by their symbols in capitals.
const std::map<std::string, Element, std::less<>>& elements() {
  static const auto all = [] {
    std::map<std::string, Element, std::less<>> table;
    for (const Row& row : kRows) {
      std::string symbol = row.symbol;
      for (char& c : symbol) c = upper(c);
      table[symbol] = {reflectance(row.rgb), row.radius};
    }
    table["D"] = table["T"] = table["H"];
    return table;
  }();
  return all;
}

}  // namespace

const Element* find_element(std::string_view word) {
  std::string letters;
  for (const char c : word) {
    if (!std::isalpha(static_cast<unsigned char>(c)) || letters.size() == 3) break;
    letters += upper(c);
  }
  const auto found = [](const std::string& symbol) {
    const auto at = elements().find(symbol);
    return at == elements().end() ? nullptr : &at->second;
  };
  if (letters.empty() || letters.size() > 2) return nullptr;
  if (const Element* whole = found(letters)) return whole;
  return found(letters.substr(0, 1));  // "OW": the oxygen of a water
}

std::string_view symbol_of(unsigned atomic_number) {
  return atomic_number >= 1 && atomic_number <= std::size(kRows) ? kRows[atomic_number - 1].symbol : "";
}

const Element& unknown_element() {
  static const Element unknown{reflectance(0xff1493u), kNoRadius};  // Jmol's colour for them
  return unknown;
}

}  // namespace umbrage
