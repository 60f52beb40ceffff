// Tests of values as colours in the program: options, hints, refusals, info and one range for several models.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli_support.h"

namespace umbrage {
namespace {

using test::kSmall;

class CliValues : public test::ProgramTest {
 protected:
  /// Writes a square of two triangles with these values at its corners.
  void write_square(const std::string& name, const std::string& values, const std::string& property = "p") {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty "
        "float " +
        property + "\nelement face 2\nproperty list uchar int vertex_indices\nproperty float part\nend_header\n";
    std::istringstream words(values);
    for (int k = 0; k < 4; ++k) {
      std::string value;
      words >> value;
      text += fmt::format("{} {} 0 {}\n", k % 2, k / 2, value);
    }
    write(name, text + "3 0 1 3 7\n3 0 3 2 8\n");
  }
  /// Returns the picture's colour in its middle, sRGB.
  std::array<float, 3> middle(const std::string& name) {
    const Image picture = image(name);
    std::array<float, 3> color{};
    for (std::size_t c = 0; c < 3; ++c) color[c] = picture.planes[c].at(picture.width / 2, picture.height / 2);
    return color;
  }
};

// A view from above that shows colours as they are in the map.
const std::string kFlat = kSmall + " --look ao --ao none --camera-direction 0,0,-1 --anti-aliasing 1";

TEST_F(CliValues, AreShownByTheirPlaceOnTheScale) {
  write_square("a.ply", "0 1 1 2");
  good("a.ply -o a.png --color-by p --color-map gray" + kFlat);
  EXPECT_NEAR(middle("a.png")[0], 0.5f, 0.02f);
  good("a.ply -o b.png --color-by p --color-map gray --color-range 0,4" + kFlat);
  EXPECT_NEAR(middle("b.png")[0], 0.25f, 0.02f);
  good("a.ply -o c.png --color-by p --color-map gray_r --color-range=-1,9 --color-bands 2" + kFlat);
  EXPECT_NEAR(middle("c.png")[0], 1.0f, 0.02f);
  write("two.csv", "255,0,0\n0,0,255\n");
  good("a.ply -o d.png --color-by p --color-map two.csv --color-range 1,3" + kFlat);
  EXPECT_NEAR(middle("d.png")[0], 1.0f, 0.02f);
  EXPECT_NEAR(middle("d.png")[2], 0.0f, 0.02f);
  write_square("log.ply", "1 10 10 100");
  good("log.ply -o e.png --color-by p --color-map gray --color-scale log" + kFlat);
  EXPECT_NEAR(middle("e.png")[0], 0.5f, 0.02f);
}

TEST_F(CliValues, ThatAreMissingAreCounted) {
  write_square("a.ply", "0 nan 1 inf");
  const auto drawn = run("a.ply -o a.png --color-by p --missing-color #ff00ff" + kFlat);
  EXPECT_EQ(drawn.code, 0);
  EXPECT_NE(drawn.err.find("2 of 2 triangles have no finite 'p' and are drawn in --missing-color #ff00ff"),
            std::string::npos)
      << drawn.err;
  EXPECT_NEAR(middle("a.png")[0], 1.0f, 0.01f);
  EXPECT_NEAR(middle("a.png")[1], 0.0f, 0.01f);
}

TEST_F(CliValues, AreNamedIfTheyAreNotShown) {
  write_square("a.ply", "0 1 1 2", "pressure");
  const auto drawn = run("a.ply -o a.png" + kSmall);
  EXPECT_EQ(drawn.code, 0);
  EXPECT_NE(drawn.err.find("'pressure'; --color-by shows values as colours"), std::string::npos) << drawn.err;
}

TEST_F(CliValues, BadRequestsAreRefused) {
  write_square("a.ply", "0 1 1 2", "pressure");
  write_square("low.ply", "-1 -1 -2 0");
  write(
      "plain.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  write("bad.csv", "1,2,3\n4,5\n");
  const auto refused = [&](const std::string& options, const test::Words& texts, const char* file = "a.ply",
                           int code = 2) { bad(std::string(file) + " -o out.png " + options + kSmall, code, texts); };
  refused("--color-by presure", {"--color-by", "'presure'", "did you mean 'pressure'?"});
  refused("--color-by heat", {"available: part, pressure"});
  refused("--color-by heat", {"'plain.ply' has no fields"}, "plain.ply");
  refused("--color-by pressure --color-range 3,3", {"--color-range", "two different numbers"});
  refused("--color-by pressure --color-range 3,1", {"--color-range", "low below high"});
  refused("--color-by pressure --color-range 0,1 --color-scale log", {"--color-range", "--color-scale log"});
  refused("--color-by p --color-scale log", {"no value above 0"}, "low.ply");
  refused("--color-by pressure --color-scale ln", {"--color-scale", "linear, log or symlog"});
  refused("--color-by pressure --component 1", {"--component", "one component, 0"});
  refused("--color-by pressure --component w", {"--component", "x, y, z or a number"});
  refused("--color-by pressure --color-map virdis", {"--color-map", "did you mean 'viridis'?"});
  refused("--color-by pressure --color-map none.csv", {"none.csv", "cannot be opened"}, "a.ply", 3);
  refused("--color-by pressure --color-map bad.csv", {"bad.csv", "line 2"}, "a.ply", 3);
  refused("--color-by pressure --color-bands 0", {"--color-bands", "1 to 256"});
  refused("--color-by pressure --color red", {"--color-by", "--color "});
  refused("--color-by pressure --material clay", {"--color-by", "--material"});
  refused("--color-by pressure --look hatching", {"--color-by", "hatching"});
}

TEST_F(CliValues, OptionsWithoutAFieldDoNothing) {
  write_square("a.ply", "0 1 1 2");
  const auto drawn = run("a.ply -o a.png --color-map magma --missing-color red" + kSmall);
  EXPECT_EQ(drawn.code, 0);
  EXPECT_NE(drawn.err.find("--color-map does nothing: --color-by names no field"), std::string::npos) << drawn.err;
  EXPECT_NE(drawn.err.find("--missing-color does nothing"), std::string::npos) << drawn.err;
}

TEST_F(CliValues, OfSeveralModelsHaveOneRange) {
  write_square("a.ply", "0 0 0 0");
  write_square("b.ply", "4 4 4 4");
  good("a.ply b.ply -o {stem}.png --same-view --color-by p --color-map gray" + kFlat);
  EXPECT_NEAR(middle("a.png")[0], 0.0f, 0.02f);
  EXPECT_NEAR(middle("b.png")[0], 1.0f, 0.02f);
}

TEST_F(CliValues, AreListedByInfo) {
  write_square("a.ply", "0.5 1 nan 2.5", "pressure");
  const std::string text = good("info a.ply").out;
  EXPECT_NE(text.find("values     pressure: on vertices"), std::string::npos) << text;
  EXPECT_NE(text.find("part: on faces 7 to 8"), std::string::npos) << text;
  const auto records = nlohmann::json::parse(good("info --json a.ply").out);
  std::vector<nlohmann::json> fields;
  for (const auto& record : records)
    if (record["what"] == "field") fields.push_back(record);
  ASSERT_EQ(fields.size(), 2u);
  EXPECT_EQ(fields[0]["name"], "pressure");
  EXPECT_EQ(fields[0]["min"], 0.5);
  EXPECT_EQ(fields[0]["max"], 2.5);
  EXPECT_EQ(fields[0]["components"], 1);
  EXPECT_GT(fields[0]["missing"], 0);
  EXPECT_EQ(fields[1]["on"], "faces");
  EXPECT_EQ(fields[1]["values"], 2);
}

}  // namespace
}  // namespace umbrage
