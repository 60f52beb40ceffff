/* Shades the depth array of another renderer, in C, here of a sphere in a corner: shade_arrays_c OUT.png */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "umbrage/umbrage.h"

enum { kWidth = 320, kHeight = 240 };

/* Returns the view depth of a sphere of radius 1 at (0, 0, -5), a floor at y = -1 and a wall at z = -7. */
static float depth_at(int x, int y) {
  const float a = 0.8f * (2.0f * ((float)x + 0.5f) / kWidth - 1.0f); /* the ray is (a, b, -1) */
  const float b = 0.6f * (1.0f - 2.0f * ((float)y + 0.5f) / kHeight);
  const float length_squared = a * a + b * b + 1.0f, discriminant = 25.0f - 24.0f * length_squared;
  float nearest = b < 0.0f ? fminf(7.0f, -1.0f / b) : 7.0f;
  if (discriminant > 0.0f) nearest = fminf(nearest, (5.0f - sqrtf(discriminant)) / length_squared);
  return nearest;
}

int main(int argc, char** argv) {
  float* depth = malloc(kWidth * kHeight * sizeof(float));
  const float window[4] = {-0.8f, 0.8f, -0.6f, 0.6f}; /* at distance 1 */
  UmbImage input = {0}, picture = {0};
  const char *message = "", *name = "color";
  UmbError code;
  UmbDevice device = umbNewDevice("cpu", 0);
  UmbJob job = umbNewShadeJob(device);
  if (!depth || !job) {
    umbGetError(&message);
    return fprintf(stderr, "%s\n", message), UMB_ERROR_DEVICE;
  }
  for (int k = 0; k < kWidth * kHeight; ++k) depth[k] = depth_at(k % kWidth, k / kWidth);
  input.data = depth;
  input.type = UMB_TYPE_FLOAT32;
  input.width = kWidth;
  input.height = kHeight;
  umbSetJobImage(job, "depth", &input);
  umbSetJobFloats(job, "window", window, 4);
  umbSetJobString(job, "look", "studio");
  umbExecuteJob(job);
  code = umbGetJobError(job, &message); /* the first error of the job */
  if (code != UMB_ERROR_NONE) fprintf(stderr, "%s\n", message);
  if (code == UMB_ERROR_NONE) code = umbGetJobOutput(job, name, &picture);
  if (code == UMB_ERROR_NONE && argc > 1) code = umbWriteImages(argv[1], &name, &picture, 1, 8, false);
  if (umbGetError(&message) != UMB_ERROR_NONE) fprintf(stderr, "%s\n", message);
  umbReleaseJob(job);
  umbReleaseDevice(device);
  free(depth);
  return code;
}
