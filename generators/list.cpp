// The list of built-in scenes.
#include <array>

#include "generators/builtin.h"
#include "generators/makers.h"

namespace umbrage {
namespace {

constexpr std::array kScenes = {
    BuiltinScene{"atrium", "an open court with two storeys of arches, coloured drapes and plants", 300'000,
                 make_atrium},
    BuiltinScene{"claw", "an armoured creature that reaches for the viewer", 160'000, make_claw},
    BuiltinScene{"pink", "a round pink sprite on a disc of meadow", 150'000, make_pink},
    BuiltinScene{"room", "a furnished living room lit through its window", 120'000, make_room},
    BuiltinScene{"solids", "a still life of simple solids that touch, lean and overlap", 100'000, make_solids},
    BuiltinScene{"tank", "a siege tank on a pad, seen from behind", 160'000, make_tank},
    BuiltinScene{"terrain", "mountains round a lake, a kilometre across", 400'000, make_terrain},
};

}  // namespace

std::span<const BuiltinScene> builtin_scenes() { return kScenes; }

}  // namespace umbrage
