// The tables that pages make their controls of: options, effects, looks and devices, as JSON.
#pragma once
#include <nlohmann/json_fwd.hpp>

namespace umbrage::view {

/// Returns an object with these lists of objects. Help names options as the command line does.
///
/// `options`: the options of a state: "name", "field", "group", "help", "unit", "initial", "kind", "min", "max",
/// "choices". "kind": flag, integer, number, text, choice, size, length, color, vector, angles or words. "min" < "max"
/// only for numbers. "repeated" if it may be given several times. "model", "gbuffer": whether it applies to these.
///
/// `effects`: "name", "summary", "kind" (occlusion, filter, shading or output), "parameters". A parameter is as an
/// option, of the kinds number, integer, choice, flag and length; "set" is its name in --set.
///
/// `looks`: "name", "summary", "effects". "gbuffer_technique": the technique of G-buffers; "techniques": that of
/// models, by quality; "technique_changes": "name" and "text" of options and parameters that give models another
/// "technique", without "text" if every text does. "presets": its settings that differ from the defaults of effects, by
/// "effect.parameter". "passes": "name", "summary". "gbuffer": whether it applies to G-buffers only.
///
/// `devices`: "name", "summary"; the CPU first.
nlohmann::json hello_tables();

}  // namespace umbrage::view
