// The table of options: every row can be set, reports its valid values, and is unique.
#include "renderer/options.h"

#include <gtest/gtest.h>

#include <set>

#include "renderer/recipe.h"

namespace umbrage {
namespace {

bool is_number(const Option& o) {
  return std::holds_alternative<FieldOf<int>>(o.where) || std::holds_alternative<FieldOf<float>>(o.where) ||
         std::holds_alternative<FieldOf<std::optional<int>>>(o.where) ||
         std::holds_alternative<FieldOf<std::optional<float>>>(o.where);
}

std::string text_of(const Option& o, double value) {
  return fmt::format("{}{}", value, o.form == OptionForm::kPercent ? "%" : "");
}

TEST(Options, NamesAreUnique) {
  std::set<std::string_view> fields, words;
  for (const Option& o : options()) {
    EXPECT_TRUE(fields.insert(o.field).second) << o.field;
    if (o.commands == 0) continue;
    EXPECT_TRUE(o.option.empty() || words.insert(o.option).second) << o.option;
    EXPECT_FALSE(o.group.empty()) << o.field;
    EXPECT_FALSE(o.help.empty()) << o.field;
  }
}

TEST(Options, NumbersAcceptOnlyTheirRange) {
  for (const Option& o : options()) {
    if (!is_number(o) || o.form == OptionForm::kSize) continue;
    SCOPED_TRACE(o.field);
    ASSERT_LT(o.min, o.max);
    const double beyond = std::max(1.0, 1e-3 * (o.max - o.min));
    for (const double value : {o.min, o.max}) {
      Request request;
      EXPECT_TRUE(set_option(o, text_of(o, value), request)) << value;
      EXPECT_TRUE(check_request(request, kMaxStripPixels)) << value;
    }
    for (const double value : {o.min - beyond, o.max + beyond}) {
      Request request;
      const auto set = set_option(o, text_of(o, value), request);
      ASSERT_FALSE(set) << value;
      EXPECT_EQ(set.error().kind, ErrorKind::kUsage);
      EXPECT_NE(set.error().message.find(fmt::format("`{}` cannot be", o.field)), std::string::npos);
      ASSERT_EQ(set.error().fields.size(), 1u);
      EXPECT_EQ(set.error().fields[0].field, o.field);
      EXPECT_EQ(set.error().fields[0].value, text_of(o, value));
    }
    Request request;
    for (const char* text : {"", "x", "1x", "nan", "1 "}) EXPECT_FALSE(set_option(o, text, request)) << text;
  }
}

TEST(Options, AnAxisNeedsNoSign) {
  Request request, signed_axis;
  for (const char* axis : {"z", "+Z"})
    ASSERT_TRUE(set_option(option_of("up"), axis, *axis == 'z' ? request : signed_axis));
  EXPECT_EQ(request.up, signed_axis.up);
  for (const char* text : {"w", "+", "zz"}) EXPECT_FALSE(set_option(option_of("up"), text, request)) << text;
}

TEST(Options, IntegersAcceptNoFractions) {
  for (const Option& o : options()) {
    if (!is_number(o) || interval_of(o).kind == NumberKind::kReal || o.form == OptionForm::kSize || o.field == "height")
      continue;
    Request request;
    const auto set = set_option(o, "1.5", request);
    ASSERT_FALSE(set) << o.field;
    EXPECT_NE(set.error().message.find("an integer"), std::string::npos) << set.error().message;
  }
}

TEST(Options, ChoicesAcceptOnlyListedValues) {
  for (const Option& o : options()) {
    Request request;
    for (const std::string_view choice : o.choices) EXPECT_TRUE(set_option(o, choice, request)) << choice;
    if (o.choices.empty()) continue;
    EXPECT_FALSE(set_option(o, "else", request)) << o.field;
  }
}

TEST(Options, LibraryChecksTheTable) {
  const auto refused = [](const Request& request, const std::string& text) {
    const auto recipe = make_recipe(request);
    ASSERT_FALSE(recipe) << text;
    EXPECT_NE(recipe.error().message.find(text), std::string::npos) << recipe.error().message;
    EXPECT_EQ(recipe.error().message.find("--"), std::string::npos) << recipe.error().message;
  };
  refused({.camera = {.zoom = 1001.0f}}, "`camera.zoom` cannot be '1001': it takes a number from 0.001 to 1000");
  refused({.layers = 17}, "`layers` cannot be '17': it takes an integer from 1 to 16");
  refused({.camera = {.direction = {{0, 0, 0}}}}, "`camera.direction`");
  refused({.camera = {.position = {{1, 2, 3}}, .focal_point = {{1, 2, 3}}}}, "its own position");
  refused({.camera = {.position = {{1, 2, 3}}, .focal_point = {{0, 0, 0}}, .direction = {{1, 0, 0}}}},
          "`camera.focal_point` and `camera.direction` both");
  refused({.camera = {.index = 0, .direction = {{1, 0, 0}}}}, "`camera.index` and `camera.direction` both");
  refused({.occlusion = "reference", .occlusion_scale = "half"}, "`occlusion_scale` cannot be 'half'");
  refused({.hdri_skybox = true}, "`hdri_skybox` needs an image");
  refused({.settings = {"upsample.factor=4"}}, "follows from `occlusion_scale`");
  refused({.settings = {"resample.right=1"}}, "follows from `anti_aliasing`");
  refused({.passes = {"layer1.depth"}}, "it requires `layers` 2");
  refused({.passes = {"nothing"}}, "writes no pass 'nothing'");
}

TEST(Options, FieldsAreRenamedInMessages) {
  EXPECT_EQ(with_option_names("`occlusion_scale` cannot be 'x' with `occlusion` y"),
            "--ao-scale cannot be 'x' with --ao y");
  EXPECT_EQ(with_option_names("`nothing` stays, and a ` alone"), "`nothing` stays, and a ` alone");
  EXPECT_EQ(with_option_names("`a` and `width`"), "`a` and --resolution");
  EXPECT_EQ(with_option_names(""), "");
}

// File names may contain field names: quoted text must not change.
TEST(Options, QuotedTextIsNotChanged) {
  const auto stays = [&](const std::string& quoted, const std::string& before, const std::string& after) {
    const std::string renamed = with_option_names(before + quoted + after + "`width`");
    EXPECT_EQ(renamed, before + quoted + after + "--resolution");
  };
  for (const char* quoted : {"'`width`.obj'", "'a `width` b'", "'it's `width`'", "'`'", "''"}) {
    stays(quoted, "", " is empty: ");
    stays(quoted, "the picture's file, ", ", or ");
    stays(quoted, "the models' sizes (", "): ");
  }
  EXPECT_EQ(with_option_names("the picture's `width` and the models' `width` or 'x'"),
            "the picture's --resolution and the models' --resolution or 'x'");
  EXPECT_EQ(with_option_names("'never closed `width`"), "'never closed --resolution");
}

}  // namespace
}  // namespace umbrage
