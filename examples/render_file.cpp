// Renders a model to a picture file: render_file MODEL OUT.png
#include <cstdio>

#include "umbrage/umbrage.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: render_file MODEL OUT.png|OUT.exr\n");
    return 2;
  }
  umb::RenderRequest request;
  request.model = argv[1];
  request.width = 640;
  request.height = 480;
  request.camera.azimuth_deg = 20.0f;
  request.passes = {"beauty", "depth", "normal"};  // only .exr files store them; beauty is their colour

  umb::Picture picture;
  umb::Outcome outcome = umb::render(request, picture);
  for (const std::string& warning : outcome.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
  if (outcome.code == 0) outcome = umb::save(picture, argv[2]);
  if (outcome.code != 0) std::fprintf(stderr, "%s\n", outcome.message.c_str());
  return outcome.code;
}
