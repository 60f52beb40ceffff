// Renders a turntable of a model and prints the time of each frame: turntable MODEL FRAMES [DEVICE]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "umbrage/umbrage.hpp"

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: turntable MODEL FRAMES [DEVICE]\n");
    return 2;
  }
  const int frames = std::atoi(argv[2]);
  umb::FrameRenderer renderer;
  umb::RenderRequest request;
  request.model = argv[1];
  request.look = "ao";
  request.width = 320;
  request.height = 240;
  if (argc > 3) request.device = argv[3];
  if (const auto opened = renderer.open(request); opened.code != 0) {
    std::fprintf(stderr, "turntable: %s\n", opened.message.c_str());
    return opened.code;
  }
  std::printf("%s\n", renderer.device().c_str());
  umb::Picture picture;
  for (int k = 0; k < frames; ++k) {
    const float angle_rad = 6.2831853f * float(k) / float(frames);
    umb::FrameCamera camera;
    camera.placed = true;
    camera.eye[0] = 8.0f * std::cos(angle_rad);
    camera.eye[1] = 4.0f;
    camera.eye[2] = 8.0f * std::sin(angle_rad);
    camera.target[2] = 0.0f;
    const auto start = std::chrono::steady_clock::now();
    if (const auto drawn = renderer.draw(camera, picture); drawn.code != 0) {
      std::fprintf(stderr, "turntable: %s\n", drawn.message.c_str());
      return drawn.code;
    }
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    std::printf("frame %d: %.1f ms, %.1f MiB on the GPU\n", k, elapsed.count(),
                double(renderer.device_bytes()) / 1048576.0);
  }
  return 0;
}
