// The parameter table, kernel constants and dispatches of `antialias` [Reshetov 2009].
#include "effects/antialias/antialias.h"

#include "core/effect.h"
#include "kernels/antialias.h"
#include "kernels/antialias_beauty.h"
#include "kernels/antialias_copy.h"
#include "kernels/antialias_edges.h"
#include "kernels/antialias_search.h"

namespace umbrage {
namespace {

const std::vector<Parameter> kAntialiasTable = {
    real_row("threshold", &AntialiasParams::threshold, {.initial = 0.04, .min = 0.001, .max = 1},
             "difference of a channel of the picture above which two pixels have an edge between them; twice this is a "
             "clear edge"),
    int_row("search", &AntialiasParams::search, {.initial = 24, .max = 64, .unit = "px", .zero_means = "off"},
            "how far an edge is followed in each direction"),
    bool_row("beauty", &AntialiasParams::beauty, false,
             "also smooth `beauty`, by the same areas; set for EXR files without the parts of `beauty`"),
};

void fill_antialias(const AntialiasParams& params, const PictureInfo&, AntialiasConstants& c) {
  c = {params.threshold, params.search};
}

bool runs_on_beauty(const ParameterBytes& bytes) {
  return as<AntialiasParams>(bytes).search > 0 && as<AntialiasParams>(bytes).beauty != 0;
}
bool runs(const ParameterBytes& bytes) { return as<AntialiasParams>(bytes).search > 0; }

// Rows above and below that the dispatches read: edges two, the search as far as it goes, the mixing one.
int reach_of_edges(const void*, int) { return 2; }
int reach_of_search(const void* constants, int) {
  return static_cast<const AntialiasConstants*>(constants)->search + 1;
}
int reach_of_blend(const void*, int) { return 1; }

}  // namespace

Effect effect_antialias() {
  return output_effect<fill_antialias>(
      kAntialiasTable,
      {.name = "antialias",
       .summary = "smooth the stair steps of edges of the finished picture",
       .source = "Reshetov 2009",
       .variants = {""},
       .dispatches = {
           {.name = "edges",
            .inputs = {"color.r", "color.g", "color.b", "color.a"},
            .outputs = {"antialias_edge_left", "antialias_edge_above", "antialias_color.r", "antialias_color.g",
                        "antialias_color.b", "antialias_color.a"},
            .kernel = antialias_edges_kernel(),
            .needed = runs,
            .reach = reach_of_edges},
           {.name = "search",
            .inputs = {"antialias_edge_left", "antialias_edge_above"},
            .outputs = {"antialias_from_left", "antialias_to_left", "antialias_from_above", "antialias_to_above"},
            .kernel = antialias_search_kernel(),
            .needed = runs,
            .reach = reach_of_search},
           {.name = "blend",
            .inputs = {"antialias_color.r", "antialias_color.g", "antialias_color.b", "antialias_color.a",
                       "antialias_from_left", "antialias_to_left", "antialias_from_above", "antialias_to_above"},
            .outputs = {"color.r", "color.g", "color.b", "color.a"},
            .kernel = antialias_kernel(),
            .needed = runs,
            .reach = reach_of_blend},
           {.name = "copy beauty",
            .inputs = {"beauty.r", "beauty.g", "beauty.b", "beauty.a"},
            .outputs = {"antialias_beauty.r", "antialias_beauty.g", "antialias_beauty.b", "antialias_beauty.a"},
            .kernel = antialias_copy_kernel(),
            .needed = runs_on_beauty,
            .reach = own_row},
           {.name = "blend beauty",
            .inputs = {"antialias_beauty.r", "antialias_beauty.g", "antialias_beauty.b", "antialias_beauty.a",
                       "antialias_from_left", "antialias_to_left", "antialias_from_above", "antialias_to_above"},
            .outputs = {"beauty.r", "beauty.g", "beauty.b", "beauty.a"},
            .kernel = antialias_beauty_kernel(),
            .needed = runs_on_beauty,
            .reach = reach_of_blend}}});
}

}  // namespace umbrage
