// Shows the progress of a slow rendering and cancels it after some seconds: progress MODEL SECONDS
#include <chrono>
#include <cstdio>

#include "umbrage/umbrage.hpp"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: progress MODEL SECONDS\n");
    return 2;
  }
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::milliseconds(long(1000.0 * std::atof(argv[2])));

  umb::RenderRequest request;
  request.model = argv[1];
  request.occlusion = "reference";  // ray traced
  request.settings = {"reference.samples=256"};
  request.progress = [&](double done) {
    std::printf("\r%3.0f %%", 100.0 * done);
    std::fflush(stdout);
    return Clock::now() < end;  // false cancels the rendering
  };
  umb::Picture picture;
  const umb::Outcome outcome = umb::render(request, picture);
  std::printf("\n%s\n", outcome.code == 0 ? "done" : outcome.message.c_str());
  return outcome.code;
}
