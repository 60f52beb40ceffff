// Tests of the memory of planes and of plane pools.
#include "core/image.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <thread>

#include "devices/cpu/cpu_device.h"
#include "scene/finish.h"
#include "scene/framing.h"

namespace umbrage {
namespace {

// A plane of this size takes 4 MB.
constexpr int kSide = 1024;

TEST(PlanePool, MemoryIsReusedForPlanesOfTheSameSize) {
  const auto pool = std::make_shared<PlanePool>();
  {
    const ScopedPlanePool scoped_pool(pool);
    { const Plane plane(kSide, kSide); }
    const std::size_t one = pool->bytes();
    EXPECT_GE(one, std::size_t(kSide) * kSide * sizeof(float));
    {
      const Plane again(kSide, kSide);
      EXPECT_EQ(pool->bytes(), 0u) << "its memory is in use again";
      const Plane other(kSide, kSide + 512), small(64, 64);
    }
    EXPECT_GT(pool->bytes(), 2 * one);
  }
  EXPECT_EQ(pool->bytes(), 0u) << "no plane is in use";
  { const Plane plane(kSide, kSide); }
  EXPECT_EQ(pool->bytes(), 0u);
}

TEST(PlanePool, KeepsPlanesFrom64KiBOn) {
  const auto pool = std::make_shared<PlanePool>();
  const ScopedPlanePool scoped_pool(pool);
  { const Plane plane(128, 127); }
  EXPECT_EQ(pool->bytes(), 0u);
  { const Plane plane(128, 128); }
  EXPECT_EQ(pool->bytes(), std::size_t(64) << 10);
}

TEST(PlanePool, ALockDoesNotPoolThePlanesOfItsThread) {
  const auto pool = std::make_shared<PlanePool>();
  const PlanePoolLock lock(pool);
  { const Plane plane(kSide, kSide); }
  EXPECT_EQ(pool->bytes(), 0u) << "planes of this thread are not pooled";
  {
    const ScopedPlanePool scoped_pool(pool);
    const Plane plane(kSide, kSide);
  }
  EXPECT_GT(pool->bytes(), 0u) << "kept while the lock exists";
}

TEST(PlanePool, EachThreadUsesItsOwnPool) {
  const auto first = std::make_shared<PlanePool>(), second = std::make_shared<PlanePool>();
  const PlanePoolLock lock(first);
  const ScopedPlanePool scoped_pool(second);
  std::optional<Plane> moved_plane;
  std::thread([&] {
    { const Plane plane(kSide, kSide); }
    EXPECT_EQ(second->bytes(), 0u) << "it belongs to another thread";
    const ScopedPlanePool scoped_first(first);
    moved_plane.emplace(kSide, kSide);
  }).join();
  moved_plane.reset();
  EXPECT_GT(first->bytes(), 0u) << "returned to the pool from which it came";
  EXPECT_EQ(second->bytes(), 0u);
}

TEST(PlanePool, TheLastCreatedIsUsedAndPlanesMayOutliveIt) {
  auto outer = std::make_shared<PlanePool>();
  const ScopedPlanePool scoped_pool(outer);
  std::optional<Plane> plane;
  {
    const ScopedPlanePool inner(std::make_shared<PlanePool>());
    plane.emplace(kSide, kSide, 0.5f);
  }
  EXPECT_EQ(plane->at(kSide - 1, kSide - 1), 0.5f);
  plane.reset();
  EXPECT_EQ(outer->bytes(), 0u) << "its memory came from the inner pool";
  plane.emplace(kSide, kSide);
  plane.reset();
  EXPECT_GT(outer->bytes(), 0u);
}

TEST(PlanePool, EachDeviceHasItsOwn) {
  Scene scene;
  scene.meshes.emplace_back();
  scene.meshes[0].positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.meshes[0].indices = {0, 1, 2};
  ASSERT_EQ(finish_scene(scene), 0u);
  const auto first = make_cpu_device(), second = make_cpu_device();
  EXPECT_NE(first->pool(), second->pool());
  ASSERT_TRUE(first->prepare(scene));
  const ScopedPlanePool scoped_pool(first->pool());
  { ASSERT_TRUE(first->capture(frame_scene(scene, {}, kSide, kSide), {.width = kSide, .height = kSide})); }
  EXPECT_GT(first->pool()->bytes(), 10 * std::size_t(kSide) * kSide * sizeof(float)) << "of depth, normals and others";
  EXPECT_EQ(second->pool()->bytes(), 0u);
}

}  // namespace
}  // namespace umbrage
