// Starts the kernel dialect inside the body of a C++ struct that has a member `view` (scalar_view.h or lanes_view.h).
// Defines the constants F (FrameConstants) and C (UMBRAGE_KERNEL_CONSTANTS) and the macros by which a kernel declares
// its planes. kernel_end.h ends the dialect. The GLSL counterpart is glsl.h.
#define FN HWY_INLINE HWY_MAYBE_UNUSED
// For a long function that few pixels need: it is not inlined (in C++; GLSL has no choice).
#define FN_RARE HWY_NOINLINE HWY_MAYBE_UNUSED
const FrameConstants F = view.frame.frame;
const UMBRAGE_KERNEL_CONSTANTS& C = *static_cast<const UMBRAGE_KERNEL_CONSTANTS*>(view.frame.constants);
// Returns the index of a pixel in every plane; X and Y are integers inside the picture. For read_NAME(place), which is
// load_NAME without border checks.
FN Int place_of(Real X, Real Y) const { return view.place_of(X, Y); }
// Declares a list in which the lanes store at most `length` x kLanes numbers. It is used in one of two ways. By slots,
// each of one number per lane: keep_NAME(slot, v) stores and kept_NAME(slot) returns them. Or by single entries:
// append_NAME(at, mask, v) stores v of the lanes whose mask is set, in order, from entry `at` on, which takes
// count_lanes(mask) entries; entries_NAME(at) returns kLanes entries from `at` on, one per lane.
#define LIST(type, number, name, length)                                                                     \
  alignas(64) number name##_list[((length) + 1) * kLanes];                                                   \
  FN void keep_##name(int slot, type v) { view.write_list(name##_list + slot * kLanes, v); }                 \
  FN type kept_##name(int slot) const { return view.read_list(name##_list + slot * kLanes); }                \
  FN void append_##name(int at, Bool where, type v) { view.write_list(name##_list + at, packed(where, v)); } \
  FN type entries_##name(int at) const { return view.read_list(name##_list + at); }
#define LIST_REAL(name, length) LIST(Real, float, name, length)
#define LIST_UINT(name, length) LIST(Uint, std::uint32_t, name, length)
// Declares a Vec3 sum per lane that every lane may add to. clear_NAME() sets all to 0; add_to_NAME(lane, v) adds each
// lane's v to the sum of lane `lane`; sum_of_NAME() returns each lane's own sum.
#define SUMS(name)                                                                \
  LaneSums name##_sums;                                                           \
  FN void clear_##name() { clear(name##_sums); }                                  \
  FN void add_to_##name(Int lane, Vec3 v) { add_to_lanes(name##_sums, lane, v); } \
  FN Vec3 sum_of_##name() const { return sums_of(name##_sums); }
FN Bool near_inside(int i, int j) const { return view.inside(i, j); }
#define CONST static constexpr
#define IN_REAL(name)                                                                             \
  const float* name##_plane = view.plane(#name);                                                  \
  FN Real load_##name(Int X, Int Y) const { return view.load(name##_plane, X, Y); }               \
  FN Real read_##name(Int place) const { return view.read(name##_plane, place); }                 \
  FN Real near_##name(int i, int j) const { return view.near(name##_plane, i, j); }               \
  FN Real corner_##name(int f, int i, int j) const { return view.corner(name##_plane, f, i, j); } \
  FN Real block_##name(int f, int i, int j) const { return view.block(name##_plane, f, i, j); }
#define IN_TRIPLE(name, a, b, c)                                                                                       \
  const float* name##_plane_0 = view.plane(#name "." a);                                                               \
  const float* name##_plane_1 = view.plane(#name "." b);                                                               \
  const float* name##_plane_2 = view.plane(#name "." c);                                                               \
  FN Vec3 load_##name(Int X, Int Y) const {                                                                            \
    return Vec3{view.load(name##_plane_0, X, Y), view.load(name##_plane_1, X, Y), view.load(name##_plane_2, X, Y)};    \
  }                                                                                                                    \
  FN Vec3 read_##name(Int place) const {                                                                               \
    return Vec3{view.read(name##_plane_0, place), view.read(name##_plane_1, place), view.read(name##_plane_2, place)}; \
  }                                                                                                                    \
  FN Vec3 near_##name(int i, int j) const {                                                                            \
    return Vec3{view.near(name##_plane_0, i, j), view.near(name##_plane_1, i, j), view.near(name##_plane_2, i, j)};    \
  }                                                                                                                    \
  FN Vec3 corner_##name(int f, int i, int j) const {                                                                   \
    return Vec3{view.corner(name##_plane_0, f, i, j), view.corner(name##_plane_1, f, i, j),                            \
                view.corner(name##_plane_2, f, i, j)};                                                                 \
  }                                                                                                                    \
  FN Vec3 block_##name(int f, int i, int j) const {                                                                    \
    return Vec3{view.block(name##_plane_0, f, i, j), view.block(name##_plane_1, f, i, j),                              \
                view.block(name##_plane_2, f, i, j)};                                                                  \
  }
// Declares the fourth plane of a colour, which IN_COLOR does not include.
#define IN_ALPHA(name)                                  \
  const float* name##_a_plane = view.plane(#name ".a"); \
  FN Real near_##name##_a(int i, int j) const { return view.near(name##_a_plane, i, j); }
#define IN_VECTOR(name) IN_TRIPLE(name, "x", "y", "z")
#define IN_COLOR(name) IN_TRIPLE(name, "r", "g", "b")
// Declares an input plane of every layer: read_NAME_of(layer, place), near_NAME_of(layer, i, j). A kernel reads only
// the layers that its constants name.
#define OF_LAYERS(text)                                                                                                \
  {                                                                                                                    \
    view.plane(text), view.plane("layer1." text), view.plane("layer2." text), view.plane("layer3." text),              \
        view.plane("layer4." text), view.plane("layer5." text), view.plane("layer6." text), view.plane("layer7." text) \
  }
#define IN_LAYERS_REAL(name)                                                                              \
  IN_REAL(name)                                                                                           \
  const float* const name##_layers[kLayersRead] = OF_LAYERS(#name);                                       \
  FN Real read_##name##_of(int layer, Int place) const { return view.read(name##_layers[layer], place); } \
  FN Real near_##name##_of(int layer, int i, int j) const { return view.near(name##_layers[layer], i, j); }
#define IN_LAYERS_TRIPLE(name, a, b, c)                                                             \
  IN_TRIPLE(name, a, b, c)                                                                          \
  const float* const name##_layers_0[kLayersRead] = OF_LAYERS(#name "." a);                         \
  const float* const name##_layers_1[kLayersRead] = OF_LAYERS(#name "." b);                         \
  const float* const name##_layers_2[kLayersRead] = OF_LAYERS(#name "." c);                         \
  FN Vec3 read_##name##_of(int layer, Int place) const {                                            \
    return Vec3{view.read(name##_layers_0[layer], place), view.read(name##_layers_1[layer], place), \
                view.read(name##_layers_2[layer], place)};                                          \
  }                                                                                                 \
  FN Vec3 near_##name##_of(int layer, int i, int j) const {                                         \
    return Vec3{view.near(name##_layers_0[layer], i, j), view.near(name##_layers_1[layer], i, j),   \
                view.near(name##_layers_2[layer], i, j)};                                           \
  }
#define IN_LAYERS_VECTOR(name) IN_LAYERS_TRIPLE(name, "x", "y", "z")
#define IN_LAYERS_COLOR(name) IN_LAYERS_TRIPLE(name, "r", "g", "b")
#define OUT_REAL(name)                     \
  float* name##_plane = view.plane(#name); \
  FN void store_##name(Real v) const { view.store(name##_plane, v); }
// Declares an output plane of every layer of the picture. A kernel must not store to layers that do not exist.
#define OUT_LAYERS_REAL(name)                                 \
  float* const name##_layers[kLayersRead] = OF_LAYERS(#name); \
  FN void store_##name##_of(int layer, Real v) const { view.store(name##_layers[layer], v); }
#define OUT_ALPHA(name)                           \
  float* name##_plane_3 = view.plane(#name ".a"); \
  FN void store_##name##_alpha(Real v) const { view.store(name##_plane_3, v); }
#define OUT_TRIPLE(name, a, b, c)                  \
  float* name##_plane_0 = view.plane(#name "." a); \
  float* name##_plane_1 = view.plane(#name "." b); \
  float* name##_plane_2 = view.plane(#name "." c); \
  FN void store_##name(Vec3 v) const {             \
    view.store(name##_plane_0, v.x);               \
    view.store(name##_plane_1, v.y);               \
    view.store(name##_plane_2, v.z);               \
  }
// Declares a plane that the dispatch modifies in place: a pixel reads only its own value.
#define INOUT_REAL(name) \
  OUT_REAL(name)         \
  FN Real own_##name() const { return view.near(name##_plane, 0, 0); }
#define INOUT_COLOR(name)                                                                                           \
  OUT_COLOR(name)                                                                                                   \
  FN Vec3 own_##name() const {                                                                                      \
    return Vec3{view.near(name##_plane_0, 0, 0), view.near(name##_plane_1, 0, 0), view.near(name##_plane_2, 0, 0)}; \
  }
#define OUT_VECTOR(name) OUT_TRIPLE(name, "x", "y", "z")
#define OUT_COLOR(name) OUT_TRIPLE(name, "r", "g", "b")
#include "kernel/common.kernel.h"
