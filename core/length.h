// Length: a number that is absolute or a share. Shared by C++ and GLSL: 4-byte scalars only.
#ifndef UMBRAGE_CORE_LENGTH_H
#define UMBRAGE_CORE_LENGTH_H

// An absolute length in the unit of its parameter, or (relative != 0) a share of a whole in percent. The parameter's
// help says of what.
struct Length {
  float value;
  int relative;
};

#ifdef __cplusplus
namespace umbrage {

/// In the unit of `whole`, which is what a share is of.
inline float absolute_length(const Length& length, float whole) {
  return length.relative != 0 ? length.value / 100.0f * whole : length.value;
}

}  // namespace umbrage
#endif

#endif
