// Progressive drawing: further samples continue the average of a plan, whatever asks for them. The progress of
// drawings: nested parts, and strips of marked samples.
#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "devices/cpu/cpu_device.h"
#include "effects/traced/traced.h"
#include "renderer/accumulation.h"
#include "renderer/draw.h"
#include "renderer/drawing.h"
#include "renderer/models.h"
#include "renderer/strips.h"
#include "renderer/times.h"

namespace umbrage {
namespace {

const std::vector<std::string> kPlanes = {"color.r", "color.g", "color.b", "color.a"};

/// A scene that is drawn progressively on a number of threads.
class Progressive {
 public:
  Progressive(const Request& request, int threads, const char* model = "scene:solids?detail=2000")
      : device_(make_cpu_device({.threads = threads})), scene_(*load_scene(model)) {
    const auto recipe = make_recipe(request);
    EXPECT_TRUE(recipe) << recipe.error().message;
    EXPECT_TRUE(complete_scene(scene_, *recipe));
    EXPECT_TRUE(device_->prepare(scene_));
    plan = *make_plan(*recipe, scene_, device_->threads());
  }

  /// Returns the picture that has at least `samples` whole samples; 0: that of the plan. Appends each mean to `means`.
  Image drawn(int samples, std::vector<Image>* means = nullptr) {
    Continuation more;
    if (samples > 0) more.wants_another = [&](int so_far) { return so_far < samples; };
    if (means)
      more.take_mean = [&](const Frame& mean, int) -> Result<void> {
        means->push_back(*device_->download(mean, kPlanes));
        return {};
      };
    return *drawn_with(more);
  }

  /// Returns the picture with the further samples that are wanted.
  std::optional<Image> drawn_with(const Continuation& more) {
    StageTimes times;
    const auto picture = draw(*device_, scene_, plan, times, {}, {}, more);
    EXPECT_TRUE(picture) << picture.error().message;
    return picture ? std::optional(*device_->download(picture->frame, kPlanes)) : std::nullopt;
  }

  Plan plan;

 private:
  std::unique_ptr<Device> device_;
  Scene scene_;
};

bool same(const Image& a, const Image& b) {
  for (const std::string& name : kPlanes)
    for (int y = 0; y < a.height; ++y)
      if (std::memcmp(a.plane(name).row(y), b.plane(name).row(y), std::size_t(a.width) * sizeof(float)) != 0)
        return false;
  return true;
}

Request small(const char* look, const char* technique, int frames) {
  Request request{.look = look, .occlusion = technique, .width = 64, .height = 48};
  request.anti_aliasing = frames;
  return request;
}

void expect_continues(const Request& request, bool marked) {
  SCOPED_TRACE(request.look + " " + request.occlusion);
  Progressive one(request, 1), two(request, 2);
  EXPECT_EQ(one.plan.marked, marked);
  const int begin = marked ? 1 : *request.anti_aliasing;
  const Image plain = one.drawn(0);
  EXPECT_TRUE(same(one.drawn(begin), plain));
  std::vector<Image> means;
  const Image longest = one.drawn(begin + 3, &means);
  EXPECT_TRUE(same(two.drawn(begin + 3), longest));
  ASSERT_EQ(means.size(), 4u);
  EXPECT_TRUE(same(means[0], plain));
  EXPECT_FALSE(same(means[1], means[2]));
  EXPECT_TRUE(same(means[2], one.drawn(begin + 2)));
  EXPECT_TRUE(same(means[3], longest));
}

TEST(Progressive, ContinuesWholeSamples) {
  expect_continues(small("ao", "bitmask", 2), false);
  expect_continues(small("cartoon", "bitmask", 3), false);
}

TEST(Progressive, ContinuesMarkedSamples) { expect_continues(small("studio", "traced", 4), true); }

TEST(Progressive, ReachesTheMeanOfAsManyWholeSamples) {
  // Marked samples are soon few among the whole ones.
  Request request = small("lit", "none", 4);
  const Image fast = Progressive(request, 2).drawn(40);
  request.anti_aliasing = 40;
  Progressive whole(request, 2);
  whole.plan.marked = false;
  const Image all = whole.drawn(0);
  Progressive four(small("lit", "none", 4), 2);
  EXPECT_TRUE(four.plan.marked);
  const Image first = four.drawn(0);
  double error = 0.0, first_error = 0.0;
  for (int y = 0; y < all.height; ++y)
    for (int x = 0; x < all.width; ++x) {
      const float expected = all.plane("color.g").at(x, y);
      error += std::abs(fast.plane("color.g").at(x, y) - expected);
      first_error += std::abs(first.plane("color.g").at(x, y) - expected);
    }
  EXPECT_LT(error, 0.5 * first_error);
}

TEST(Progressive, DividesEachPixelByItsPictures) {
  PictureSum total = empty_sum({"ao"}, 2, {0, 1});
  total.marks = Plane(2, 1, 0.0f);
  total.marks.at(1, 0) = 1.0f;
  const auto picture = [](float value) {
    Image image(2, 1);
    image.add("ao") = Plane(2, 1, value);
    return image;
  };
  const auto add = [&](float value, bool whole) {
    count_sample(total, whole);
    add_rows(total, picture(value), 0, whole);
  };
  add(1.0f, true);
  add(3.0f, false);
  add(5.0f, true);
  const std::vector<std::string> names = {"ao"};
  EXPECT_EQ(mean_planes(total, names).plane("ao").at(0, 0), 3.0f);  // (1 + 5) / 2
  EXPECT_EQ(mean_planes(total, names).plane("ao").at(1, 0), 3.0f);  // (1 + 3 + 5) / 3
  add(9.0f, true);
  EXPECT_EQ(mean_planes(total, names).plane("ao").at(0, 0), 5.0f);
  EXPECT_EQ(mean_planes(total, names).plane("ao").at(1, 0), 4.5f);
}

TEST(Progressive, NeverRepeatsPositionsOrNoise) {
  Progressive picture(small("ao", "traced", 4), 1);
  std::set<std::pair<float, float>> positions;
  std::set<int> noises;
  constexpr int kSamples = 1000;
  glm::vec2 mean(0.0f);
  for (int k = 0; k < kSamples; ++k) {
    begin_picture(picture.plan, {.sample = k});
    noises.insert(params_of<TracedParams>(picture.plan.recipe.settings).sample_index);
    const glm::vec2 offset = sample_offset(k, 4);
    positions.insert({offset.x, offset.y});
    mean += offset / float(kSamples);
    if (k >= 4) {  // further positions do not depend on the number of the first ones
      EXPECT_EQ(offset, sample_offset(k, 3));
    }
  }
  EXPECT_EQ(positions.size(), std::size_t(kSamples));
  EXPECT_EQ(noises.size(), std::size_t(kSamples));
  EXPECT_LT(glm::max(std::abs(mean.x), std::abs(mean.y)), 0.005f);
}

TEST(TimeLimit, StopsBeforeAPictureThatWouldNotFit) {
  double now = 100.0;
  TimeLimit limit(10.0, [&] { return now; });
  now += 4.0;
  EXPECT_TRUE(limit.fits_another(4));  // four took 4 s: 5 s with another
  now += 3.0;
  EXPECT_TRUE(limit.fits_another(5));  // 7 + 3
  now += 1.0;
  EXPECT_FALSE(limit.fits_another(6));  // 8 + the upper median of 1 and 3
  EXPECT_EQ(limit.samples(), 6);
  EXPECT_EQ(limit.elapsed(), 8.0);
  now += 0.5;
  EXPECT_TRUE(limit.fits_another(7));  // 8.5 + the median 1
}

TEST(TimeLimit, PartsOfASampleFillTheRest) {
  double now = 0.0;
  TimeLimit limit(10.0, [&] { return now; });
  now = 3.0;
  EXPECT_TRUE(limit.fits_another(1));
  now = 8.5;
  EXPECT_FALSE(limit.fits_another(2));  // 8.5 + 5.5
  EXPECT_TRUE(limit.fits_part(0.1));    // 8.5 + 0.55
  now = 9.3;                            // strips take longer: 8 a sample
  EXPECT_FALSE(limit.fits_part(0.1));
  EXPECT_TRUE(limit.fits_part(0.05));
  EXPECT_FLOAT_EQ(limit.part(), 0.15f);
}

TEST(Progressive, PartsOfASampleUseTheTime) {
  // A picture takes 10 s, and strips of it a quarter longer than their part. Of any time, at least 90 % is used.
  Request request{.look = "studio", .occlusion = "traced", .width = 64, .height = 512};
  Progressive picture(request, 2);
  for (const double seconds : {28.0, 33.0, 37.5}) {
    double now = 0.0;
    TimeLimit limit(seconds, [&] { return now; });
    now = 10.0;  // of the samples of the plan
    Continuation more;
    more.wants_another = [&](int samples) {
      const bool fits = limit.fits_another(samples);
      if (fits) now += 10.0;
      return fits;
    };
    more.wants_part = [&](double fraction) {
      const bool fits = limit.fits_part(fraction);
      if (fits) now += 12.5 * fraction;
      return fits;
    };
    EXPECT_TRUE(picture.drawn_with(more));
    EXPECT_GE(now, 0.9 * seconds);
    EXPECT_LE(now, 1.02 * seconds);
  }
}

TEST(Progressive, APartOfASampleIsTheUpperRowsOfIt) {
  for (const auto& [look, technique, frames] : {std::tuple("studio", "traced", 4), {"lit", "none", 3}}) {
    Request request = small(look, technique, frames);
    request.height = 192;
    Progressive picture(request, 2);
    const int begin = picture.plan.marked ? 1 : frames;
    const Image before = picture.drawn(0), whole = picture.drawn(begin + 1);
    for (const int parts : {0, 1, 2, 3}) {
      int asked = 0;
      Continuation more;
      more.wants_another = [](int) { return false; };
      more.wants_part = [&](double fraction) {
        EXPECT_NEAR(fraction, 1.0 / 3.0, 1e-6);
        return asked++ < parts;
      };
      const auto drawn = picture.drawn_with(more);
      ASSERT_TRUE(drawn);
      SCOPED_TRACE(std::string(look) + " " + std::to_string(parts));
      for (const std::string& name : kPlanes)
        for (int y = 0; y < request.height; ++y) {
          const Plane& expected = (y < 64 * parts ? whole : before).plane(name);
          for (int x = 0; x < request.width; ++x)
            ASSERT_NEAR(drawn->plane(name).at(x, y), expected.at(x, y), 1e-5f) << name << ' ' << x << ' ' << y;
        }
    }
  }
}

TEST(Progressive, APartWithinTheGuardBandChangesNothing) {
  Request request = small("studio", "traced", 4);
  request.height = 192;
  request.guard_band = 50.0f;  // 96 rows, more than those of a part
  Progressive picture(request, 2);
  const Image before = picture.drawn(0);
  int asked = 0;
  Continuation more;
  more.wants_another = [](int) { return false; };
  more.wants_part = [&](double) { return asked++ < 1; };
  const auto drawn = picture.drawn_with(more);
  ASSERT_TRUE(drawn);
  for (const std::string& name : kPlanes)
    for (int y = 0; y < request.height; ++y)
      for (int x = 0; x < request.width; ++x)
        ASSERT_NEAR(drawn->plane(name).at(x, y), before.plane(name).at(x, y), 1e-5f) << name << ' ' << x << ' ' << y;
}

TEST(Progressive, DrawsNoPartOfAPictureThatReadsAnyRow) {
  Continuation more;
  more.wants_another = [](int) { return false; };
  more.wants_part = [](double) {
    ADD_FAILURE() << "asked";
    return false;
  };
  EXPECT_TRUE(Progressive(small("ao", "bitmask", 2), 2).drawn_with(more));
}

TEST(TimeLimit, EndsAtOnceIfThePlanTookLonger) {
  double now = 0.0;
  TimeLimit limit(1.0, [&] { return now; });
  now = 3.0;
  EXPECT_FALSE(limit.fits_another(4));
}

TEST(DrawProgress, PartsAreFractionsOfThePartAroundThem) {
  double reported = -1.0;
  const ProgressMonitor monitor = [&](double done) { return reported = done, true; };
  DrawProgress progress(monitor, 2);
  const ProgressMonitor step = progress.step_monitor();
  {
    const DrawProgress::Part sample(progress, 0.5, 1.0);
    step(0.5);
    EXPECT_DOUBLE_EQ(reported, 0.5 + 0.5 * 0.25);
    progress.step_done();
    {
      const DrawProgress::Part strip(progress, 0.75, 1.0);
      step(0.0);
      EXPECT_DOUBLE_EQ(reported, 0.875) << "a part begins with no step";
    }
    step(1.0);
    EXPECT_DOUBLE_EQ(reported, 1.0) << "the part around it goes on after its first step";
  }
  const DrawProgress::Part earlier(progress, 0.0, 0.1);
  step(0.0);
  EXPECT_DOUBLE_EQ(reported, 1.0) << "progress never decreases";
}

TEST(DrawProgress, OfStripsOfMarkedSamplesGrowsSteadily) {
  Request request{.look = "studio", .width = 80, .height = 256};
  const auto recipe = make_recipe(request);
  Scene scene = *load_scene("scene:solids?detail=2000");
  EXPECT_TRUE(complete_scene(scene, *recipe));
  const auto device = make_cpu_device();
  ASSERT_TRUE(device->prepare(scene));
  const auto plan = make_plan(*recipe, scene, device->threads());
  ASSERT_TRUE(plan && plan->marked);
  std::vector<double> reported = {0.0};
  const auto monitor = [&](double done) { return reported.push_back(done), true; };
  StageTimes times;
  const auto take = [](const PictureInfo&, const Image&, int) { return Result<void>(); };
  ASSERT_TRUE(draw_strips(*device, *plan, 64, {"color.r"}, false, take, times, monitor));
  EXPECT_DOUBLE_EQ(reported.back(), 1.0);
  double largest = 0.0;
  for (std::size_t k = 1; k < reported.size(); ++k) {
    EXPECT_GE(reported[k], reported[k - 1]);
    largest = std::max(largest, reported[k] - reported[k - 1]);
  }
  EXPECT_LT(largest, 1.0 / 8.0) << "each picture of a strip counts";
}

}  // namespace
}  // namespace umbrage
