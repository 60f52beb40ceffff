#include <fmt/core.h>
#include "apps/job/job.h"
#include "io/image_file.h"
using namespace umbrage;
int main(int argc, char** argv) {
  StageTimes times;
  DrawSettings d; d.look = argc > 3 ? argv[3] : "unsharp";
  for (int i = 4; i < argc; ++i) d.settings.push_back(argv[i]);
  auto scene = load_scene(argv[1]);
  if (!scene) { fmt::print(stderr, "{}\n", scene.error().message); return 3; }
  times.done("load");
  auto device = make_device("cpu", 0);
  auto ok = (*device)->prepare(*scene);
  times.done("prepare");
  auto frame = draw(**device, *scene, d, times);
  if (!frame) { fmt::print(stderr, "{}\n", frame.error().message); return 3; }
  auto image = (*device)->download(*frame, {"color.r", "color.g", "color.b"});
  auto w = write_image(argv[2], *image);
  times.done("write");
  for (auto& s : times.stages) fmt::print("{} {:.1f}\n", s.name, s.ms);
  fmt::print("total {:.1f}\n", times.total());
}
