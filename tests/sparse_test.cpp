// Planes that know where they hold something: cells, passes that say where they store anything, and frames whose
// memory held another picture before.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include "core/image.h"
#include "devices/cpu/cells.h"
#include "effects/effects.h"
#include "run_effect.h"
#include "support.h"

namespace umbrage {
namespace {

/// The cells of row y as a text, one letter each.
std::string row_text(const Cells& cells, const std::uint64_t* row) {
  std::string text;
  for (int cell = 0; cell < cells.in_row; ++cell) text += row[cell / 64] >> (cell % 64) & 1 ? '#' : '.';
  return text;
}

std::string cells_near(const Plane& plane, int columns, int rows, int y) {
  std::vector<std::uint64_t> near(plane.cells()->words, ~std::uint64_t(0));
  const NearCells source{plane.cells(), columns, rows};
  find_near_cells({&source, 1}, y, near.data());
  return row_text(*plane.cells(), near.data());
}

/// Puts a number into a pixel, as a pass does.
void put(Plane& plane, int x, int y, float value) {
  plane.at(x, y) = value;
  plane.cells()->row(y)[x / kCellWidth / 64] |= std::uint64_t(1) << (x / kCellWidth % 64);
}

TEST(Sparse, NearCellsAreThoseWithinColumnsAndRows) {
  Plane plane = Plane::sparse(100, 9);
  EXPECT_EQ(plane.cells()->words, 1);
  put(plane, 50, 4, 1.0f);
  EXPECT_EQ(cells_near(plane, 0, 0, 4), "...#...");
  EXPECT_EQ(cells_near(plane, 1, 0, 4), "..###..");
  EXPECT_EQ(cells_near(plane, 16, 0, 4), "..###..");
  EXPECT_EQ(cells_near(plane, 17, 0, 4), ".#####.");
  EXPECT_EQ(cells_near(plane, 1000, 0, 4), "#######");
  EXPECT_EQ(cells_near(plane, 0, 0, 5), ".......");
  EXPECT_EQ(cells_near(plane, 0, 1, 5), "...#...");
  EXPECT_EQ(cells_near(plane, 0, 3, 8), ".......");
  EXPECT_EQ(cells_near(plane, 0, 4, 8), "...#...");
}

TEST(Sparse, NearCellsReachOverTheEndsOfWords) {
  Plane plane = Plane::sparse(16 * 64 * 2 + 5, 1);
  ASSERT_EQ(plane.cells()->words, 3);
  put(plane, 16 * 64 - 1, 0, 1.0f);  // the last cell of the first word
  put(plane, 16 * 64 * 2, 0, 1.0f);  // and the only one of the last
  EXPECT_EQ(cells_near(plane, 32, 0, 0), std::string(61, '.') + "#####" + std::string(60, '.') + "###");
}

TEST(Sparse, KeepingClearsTheOthersAndNotingDropsWhatIsEmpty) {
  Plane plane = Plane::sparse(70, 2);
  for (const int x : {0, 20, 40, 69}) put(plane, x, 1, float(x) + 1.0f);
  const std::uint64_t kept = 0b10010;  // cells 1 and 4
  keep_cells(plane, 1, &kept, false);
  EXPECT_EQ(row_text(*plane.cells(), plane.cells()->row(1)), ".#..#");
  EXPECT_EQ(plane.at(0, 1), 0.0f);
  EXPECT_EQ(plane.at(20, 1), 21.0f);
  EXPECT_EQ(plane.at(40, 1), 0.0f);
  EXPECT_EQ(plane.at(69, 1), 70.0f);
  plane.at(20, 1) = 0.0f;
  note_cells(plane, 1);
  EXPECT_EQ(row_text(*plane.cells(), plane.cells()->row(1)), "....#");
  keep_cells(plane, 1, &kept, true);
  EXPECT_EQ(plane.at(69, 1), 0.0f);
  keep_all_cells(plane, 0);
  EXPECT_EQ(row_text(*plane.cells(), plane.cells()->row(0)), "#####");
}

TEST(Sparse, MemoryOfPlanesThatAreGoneComesBackWithItsCells) {
  const KeptPlanes kept;
  const float* data = nullptr;
  {
    Plane plane = Plane::sparse(1024, 600);
    put(plane, 1000, 500, 7.0f);
    data = plane.data();
    const Plane copy = plane;
    EXPECT_EQ(copy.cells(), nullptr) << "a copy is an ordinary plane";
    EXPECT_EQ(copy.at(1000, 500), 7.0f);
    EXPECT_EQ(copy.at(999, 500), 0.0f);
  }
  const Plane other = Plane::sparse(1008, 600);
  EXPECT_NE(other.data(), data);
  const Plane plane = Plane::sparse(1024, 600);
  ASSERT_EQ(plane.data(), data) << "the memory was not taken again";
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x)
      if (plane.at(x, y) != 0.0f) {
        ASSERT_TRUE(plane.cells()->row(y)[x / kCellWidth / 64] >> (x / kCellWidth % 64) & 1) << x << " " << y;
      }
}

/// Spheres before a tilted plane: lines that are few and far apart, as in pictures.
GBuffer spheres(int width, int height, unsigned seed) {
  GBuffer gbuffer = test::bumpy_gbuffer(width, height, seed);
  Image& layer = gbuffer.layers[0];
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double depth = 20.0 + 0.01 * y;
      double normal[3] = {0.0, 0.0, 1.0};
      int object = 0;
      for (unsigned k = 1; k <= 4; ++k) {
        const double radius = 0.08 * height + test::hash(seed + k) % 8;
        const double dx = x - double(test::hash(seed + 10 * k) % unsigned(width));
        const double dy = y - double(test::hash(seed + 20 * k) % unsigned(height));
        const double inside = radius * radius - dx * dx - dy * dy;
        if (inside < 0.0) continue;
        const double z = std::sqrt(inside);
        depth = 10.0 + k - 0.01 * z;
        normal[0] = dx / radius, normal[1] = -dy / radius, normal[2] = z / radius;
        object = int(k);
      }
      layer.plane("depth").at(x, y) = float(depth);
      layer.plane("normal.x").at(x, y) = float(normal[0]);
      layer.plane("normal.y").at(x, y) = float(normal[1]);
      layer.plane("normal.z").at(x, y) = float(normal[2]);
      layer.plane("object_id").at(x, y) = float(object);
      layer.plane("material_id").at(x, y) = float(object);
    }
  return gbuffer;
}

/// With light that lines are drawn over.
GBuffer lit(GBuffer gbuffer) {
  for (const char* name : {"lit.r", "lit.g", "lit.b"})
    gbuffer.layers[0].add(name) = Plane(gbuffer.info.width, gbuffer.info.height, 0.5f);
  return gbuffer;
}

std::uint32_t bits_of(float v) { return std::bit_cast<std::uint32_t>(v); }

bool holds(float v) { return bits_of(v) != 0; }

/// Whether any pixel around one holds something, in a plane as `where` counts it.
bool holds_near(const Plane& plane, int x, int y, int columns, int rows) {
  for (int j = std::max(y - rows, 0); j <= std::min(y + rows, plane.height - 1); ++j)
    for (int i = std::max(x - columns, 0); i <= std::min(x + columns, plane.width - 1); ++i)
      if (holds(plane.at(i, j))) return true;
  return false;
}

TEST(Sparse, PassesSayOfInputsWhereTheyStoreAndPackedOnesOfPixelsAlone) {
  const auto has = [](const std::vector<std::string_view>& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const Effect* effect : effects())
    for (const Pass& pass : effect->passes) {
      for (const Where& where : pass.where) {
        EXPECT_TRUE(has(pass.inputs, where.plane)) << pass.name << " " << where.plane;
        EXPECT_FALSE(has(pass.outputs, where.plane)) << pass.name << " " << where.plane;
        EXPECT_FALSE(pass.packed && (where.columns || where.rows)) << pass.name << " " << where.plane;
      }
      if (!pass.where.empty()) {
        for (const std::string_view output : pass.outputs)
          EXPECT_FALSE(has(pass.inputs, output)) << pass.name << " changes " << output << " in place";
      }
      EXPECT_FALSE(pass.packed && pass.where.empty()) << pass.name;
    }
}

/// A picture whose rows are those of a high one, a narrow strip of it.
GBuffer high_strip(unsigned seed) { return spheres(72, 1300, seed); }

// Devices pass over what a pass says it stores nothing to, so it must be true of the plain kernel.
TEST(Sparse, PassesStoreNothingWhereTheySaySo) {
  int passes = 0;
  for (const Effect* effect : effects())
    for (const unsigned seed : {3u, 4u, 5u}) {
      const GBuffer gbuffer = lit(seed == 3   ? spheres(191, 347, seed)
                                  : seed == 4 ? test::hostile_gbuffer(97, 61, seed)
                                              : high_strip(seed));
      const bool says = std::any_of(effect->passes.begin(), effect->passes.end(),
                                    [](const Pass& pass) { return !pass.where.empty(); });
      if (!says) continue;
      // Wide lines are looked for farther away.
      test::Settings settings;
      if (seed == 5 && find_parameter(*effect, "width")) settings = {{"width", "16"}};
      const ParameterBytes params = test::parameters_of(*effect, settings);
      const Image image = test::run_effect(*effect, gbuffer, settings, {.scalar = true});
      std::vector<std::byte> constants(effect->constants_size);
      effect->constants(params, gbuffer.info, constants.data());
      for (const Pass& pass : effect->passes) {
        if (pass.where.empty() || (pass.needed && !pass.needed(params))) continue;
        ++passes;
        long stored = 0, wrong = 0;
        for (const std::string_view output : pass.outputs) {
          const Plane& out = image.plane(output);
          for (int y = 0; y < out.height; ++y)
            for (int x = 0; x < out.width; ++x) {
              if (!holds(out.at(x, y))) continue;
              ++stored;
              bool near = false;
              for (const Where& where : pass.where)
                near = near ||
                       holds_near(image.plane(where.plane), x, y, where.columns ? where.columns(constants.data()) : 0,
                                  where.rows ? where.rows(constants.data()) : 0);
              wrong += !near;
            }
        }
        EXPECT_EQ(wrong, 0) << effect->name << ", pass " << pass.name << ", of " << stored;
      }
    }
  EXPECT_GE(passes, 17) << "the outline's alone";
}

// What an earlier run left in a frame's planes, or in the memory that they got, is not seen.
TEST(Sparse, WhatWasDrawnBeforeIsGone) {
  const Effect& effect = *find_effect("outline");
  const GBuffer many = lit(spheres(1040, 600, 7)), few = lit(spheres(1040, 600, 8));
  const auto names = test::made_planes(effect, test::parameters_of(effect, {}));
  const auto draw = [&](Device& device, const GBuffer& gbuffer, const test::Settings& before) {
    auto frame = device.upload(gbuffer);
    if (!before.empty()) {
      EXPECT_TRUE(device.run(effect, test::parameters_of(effect, before), *frame));
    }
    for (const char* name : {"lit.r", "lit.g", "lit.b"}) {
      Image light(gbuffer.info.width, gbuffer.info.height);
      light.add(name) = gbuffer.layers[0].plane(name);
      EXPECT_TRUE(device.add(light, *frame));
    }
    EXPECT_TRUE(device.run(effect, test::parameters_of(effect, {}), *frame));
    return *device.download(*frame, names);
  };
  const auto device = make_cpu_device({});
  const Image fresh = draw(*device, few, {});
  const Image again = draw(*device, few, {{"crease", "5"}, {"depth", "0.5"}});
  const KeptPlanes kept;
  draw(*device, many, {});
  const Image after = draw(*device, few, {});
  long lines = 0;
  for (std::size_t p = 0; p < names.size(); ++p)
    for (int y = 0; y < fresh.height; ++y)
      for (int x = 0; x < fresh.width; ++x) {
        const float v = fresh.planes[p].at(x, y);
        lines += names[p] == "outline" && v > 0.5f;
        ASSERT_EQ(bits_of(v), bits_of(again.planes[p].at(x, y))) << names[p] << " " << x << " " << y;
        ASSERT_EQ(bits_of(v), bits_of(after.planes[p].at(x, y))) << names[p] << " " << x << " " << y;
      }
  EXPECT_GT(lines, 500);
}

// A G-buffer may bring planes of any name, as shades of an earlier run that was saved whole: they are ordinary planes.
TEST(Sparse, WhatAFileBringsUnderAPassesNamesIsGone) {
  const Effect& effect = *find_effect("outline");
  const GBuffer gbuffer = lit(spheres(191, 347, 9));
  const auto names = test::made_planes(effect, test::parameters_of(effect, {}));
  const Image fresh = test::run_effect(effect, gbuffer, {}, {});
  for (const char* brought : {"outline_right_settled", "outline_steep", "outline_flat_fit", "outline_tails",
                              "outline_steep_left", "outline_join_pen", "outline_around"}) {
    GBuffer other = gbuffer;
    other.layers[0].add(brought) = Plane(gbuffer.info.width, gbuffer.info.height, 3.0f);
    const Image image = test::run_effect(effect, other, {}, {});
    for (std::size_t p = 0; p < names.size(); ++p) {
      long wrong = 0;
      for (int y = 0; y < fresh.height; ++y)
        for (int x = 0; x < fresh.width; ++x)
          wrong += bits_of(fresh.planes[p].at(x, y)) != bits_of(image.planes[p].at(x, y));
      EXPECT_EQ(wrong, 0) << names[p] << " after " << brought;
    }
  }
}

}  // namespace
}  // namespace umbrage
