// Shades the depth array of another renderer, here of a sphere in a corner: shade_arrays OUT.png
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "umbrage/umbrage.hpp"

int main(int argc, char** argv) {
  const int width = 320, height = 240;
  std::vector<float> depth;  // along the view axis, row by row from the top
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // The scene is a sphere of radius 1 at (0, 0, -5), a floor at y = -1 and a wall at z = -7. The ray is (a, b, -1).
      const float a = 0.8f * (2.0f * (float(x) + 0.5f) / width - 1.0f),
                  b = 0.6f * (1.0f - 2.0f * (float(y) + 0.5f) / height);
      const float length_squared = a * a + b * b + 1.0f, discriminant = 25.0f - 24.0f * length_squared;
      float nearest = b < 0.0f ? std::min(7.0f, -1.0f / b) : 7.0f;
      if (discriminant > 0.0f) nearest = std::min(nearest, (5.0f - std::sqrt(discriminant)) / length_squared);
      depth.push_back(nearest);
    }
  umb::ShadeRequest request;
  request.width = width;
  request.height = height;
  request.left = -0.8f, request.right = 0.8f, request.bottom = -0.6f, request.top = 0.6f;  // at distance 1
  request.arrays.push_back({"depth", depth.data()});
  request.passes = {"ao"};  // in addition to the picture of the look

  umb::Picture picture;
  umb::Outcome outcome = umb::shade(request, picture);
  if (outcome.code == 0) {
    const std::vector<float>& ao = picture.passes[0].values;
    std::printf("min ambient visibility: %.2f\n", double(*std::min_element(ao.begin(), ao.end())));
  }
  if (outcome.code == 0 && argc > 1) outcome = umb::save(picture, argv[1]);
  if (outcome.code != 0) std::fprintf(stderr, "%s\n", outcome.message.c_str());
  return outcome.code;
}
