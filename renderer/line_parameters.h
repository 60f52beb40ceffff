// LineParameters: the parameters of the effects that draw lines.
#pragma once
#include "core/parameters.h"

namespace umbrage {

/// Parameters of the effects whose lines a picture has; empty for an effect whose lines it does not have.
struct LineParameters {
  ParameterBytes outline, hidden, hatching;

  bool empty() const { return outline.empty() && hidden.empty() && hatching.empty(); }
};

}  // namespace umbrage
