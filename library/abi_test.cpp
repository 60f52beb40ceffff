// Checks the layout of the C interface's structs, which must not change within a version of the interface. The
// functions are listed in symbols.txt, which the package's test compares.
#include <gtest/gtest.h>

#include <cstddef>

#include "core/strokes.h"
#include "core/version.h"
#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

static_assert(sizeof(void*) == 8, "the figures are those of 64-bit systems");

TEST(Abi, StructsAreAsRecorded) {
  EXPECT_EQ(sizeof(UmbImage), 48u);
  EXPECT_EQ(offsetof(UmbImage, type), 8u);
  EXPECT_EQ(offsetof(UmbImage, channels), 20u);
  EXPECT_EQ(offsetof(UmbImage, channel_stride), 24u);
  EXPECT_EQ(offsetof(UmbImage, row_stride), 40u);
  EXPECT_EQ(sizeof(UmbStrokePoint), 12u);
  EXPECT_EQ(sizeof(UmbStroke), 32u);
  EXPECT_EQ(offsetof(UmbStroke, kind), 16u);
  EXPECT_EQ(offsetof(UmbStroke, closed), 24u);
  EXPECT_EQ(sizeof(UmbView), 120u);
  EXPECT_EQ(offsetof(UmbView, orthographic), 112u);
  EXPECT_EQ(sizeof(UmbParameter), 72u);
  EXPECT_EQ(offsetof(UmbParameter, name), 8u);
  EXPECT_EQ(offsetof(UmbParameter, min), 56u);
}

TEST(Abi, NumbersAreAsRecorded) {
  EXPECT_EQ(UMB_ERROR_INTERNAL, 1);
  EXPECT_EQ(UMB_ERROR_USAGE, 2);
  EXPECT_EQ(UMB_ERROR_FILE, 3);
  EXPECT_EQ(UMB_ERROR_DEVICE, 4);
  EXPECT_EQ(UMB_ERROR_CANCELLED, 130);
  EXPECT_EQ(UMB_TYPE_FLOAT32, 1);
  EXPECT_EQ(UMB_TYPE_UINT32, 5);
  EXPECT_EQ(UMB_STROKE_OUTLINE, int(StrokeKind::kOutline));
  EXPECT_EQ(UMB_STROKE_FOLD, int(StrokeKind::kFold));
  EXPECT_EQ(UMB_STROKE_CREASE, int(StrokeKind::kCrease));
  EXPECT_EQ(UMB_STROKE_HATCH, int(StrokeKind::kHatch));
  EXPECT_EQ(UMB_STROKE_CROSS_HATCH, int(StrokeKind::kCrossHatch));
  EXPECT_EQ(UMB_STROKE_HIDDEN, int(StrokeKind::kHidden));
  EXPECT_EQ(UMB_STROKE_HIDDEN, 5);
  EXPECT_EQ(UMB_LIST_LOOKS, 1);
  EXPECT_EQ(UMB_LIST_FILE_FORMATS, 6);
}

TEST(Abi, TheVersionIsTheProjects) {
  const std::string text = std::to_string(UMB_VERSION_MAJOR) + "." + std::to_string(UMB_VERSION_MINOR) + "." +
                           std::to_string(UMB_VERSION_PATCH);
  EXPECT_EQ(text, project_version());
  EXPECT_EQ(umbGetVersion(), UMB_VERSION);
}

}  // namespace
}  // namespace umbrage
