/* Renders a mesh from memory, in C: a pyramid in two places. render_mesh_c OUT.png */
#include <stdint.h>
#include <stdio.h>

#include "umbrage/umbrage.h"

int main(int argc, char** argv) {
  static const float kPositions[5][3] = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 1.5f, 0}};
  static const uint8_t kIndices[6][3] = {{0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}, {0, 1, 2}, {0, 2, 3}};
  static const float kClay[3] = {0.7f, 0.35f, 0.2f};
  static const float kPlaces[2][12] = {{1, 0, 0, -1.5f, 0, 1, 0, 0, 0, 0, 1, 0},
                                       {0.5f, 0, 0, 1, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0}};
  static uint8_t pixels[240][320][3];
  const char *message = "", *name = "color";
  UmbImage picture = {pixels, UMB_TYPE_UINT8, 320, 240, 3, 0, 0, 0};
  UmbError code;
  UmbDevice device = umbNewDevice("cpu", 0);
  UmbScene scene = umbNewScene(device);
  UmbJob job = umbNewRenderJob(device, scene);
  const int mesh = umbAddMesh(scene, "pyramid", 5, 6);
  umbSetMeshBuffer(scene, mesh, "position", kPositions, UMB_TYPE_FLOAT32, 3, 0);
  umbSetMeshBuffer(scene, mesh, "index", kIndices, UMB_TYPE_UINT8, 3, 0);
  umbSetMeshFloats(scene, mesh, "albedo", kClay, 3);
  umbAddMeshInstance(scene, mesh, kPlaces[0]);
  umbAddMeshInstance(scene, mesh, kPlaces[1]);
  umbSetJobInt(job, "width", 320);
  umbSetJobInt(job, "height", 240);
  umbSetJobOutput(job, name, &picture); /* writes to memory of the program */
  umbExecuteJob(job);
  code = umbGetSceneError(scene, &message); /* the first error of the scene */
  if (code != UMB_ERROR_NONE) fprintf(stderr, "scene: %s\n", message);
  if (code == UMB_ERROR_NONE) {
    code = umbGetJobError(job, &message);
    if (code != UMB_ERROR_NONE) fprintf(stderr, "job: %s\n", message);
  }
  if (code == UMB_ERROR_NONE && argc > 1) code = umbWriteImages(argv[1], &name, &picture, 1, 8, false);
  if (umbGetError(&message) != UMB_ERROR_NONE) fprintf(stderr, "%s\n", message);
  umbReleaseJob(job);
  umbReleaseScene(scene);
  umbReleaseDevice(device);
  return code;
}
