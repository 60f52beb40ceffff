// The layers in which sample points look for occluders, and the cameras of these layers, for constants with the fields
// of HemisphereConstants from `layer_count` to `move`.
#pragma once
#include <algorithm>
#include <glm/matrix.hpp>

#include "core/gbuffer.h"
#include "kernel/frame_constants.h"

namespace umbrage {

/// Fills in the layers to search, in order, and their cameras. `layers`: their max number; 0: all.
template <class Constants>
void fill_layer_views(int layers, const PictureInfo& info, Constants& c) {
  const int available = std::min(int(info.more_layers.size()) + 1, layers > 0 ? layers : kLayersRead);
  const int max_layers = std::min(available, kLayersRead);
  const auto info_of = [&](int layer) -> const LayerInfo& { return info.more_layers[std::size_t(layer) - 1]; };
  // Returns the layer that defines the camera of `layer`: 0 for the first camera, or a layer of kind kOther.
  const auto view_of = [&](int layer) {
    for (int step = 0; layer > 0 && step < kLayersRead && info_of(layer).kind != LayerKind::kOther; ++step)
      layer = std::clamp(info_of(layer).of, 0, int(info.more_layers.size()));
    return layer;
  };
  int previous_view = -1;
  for (int view = 0; view < max_layers; ++view)  // so that the layers of one camera are consecutive
    for (int layer = 0; layer < max_layers; ++layer) {
      if (view_of(layer) != view || (layer > 0 && info_of(layer).kind == LayerKind::kBack)) continue;
      const int i = c.layer_count++;
      c.layer[i] = layer;
      c.back[i] = -1;
      for (int k = 1; k < max_layers; ++k)
        if (info_of(k).kind == LayerKind::kBack && info_of(k).of == layer) c.back[i] = k;
      c.other[i] = view > 0 ? 1 : 0;
      c.new_view[i] = view != previous_view ? 1 : 0;
      previous_view = view;
      c.view_end[i] = i + 1;
      for (int k = 0; k < i; ++k)
        if (c.view_end[k] == i && c.new_view[i] == 0) c.view_end[k] = i + 1;
      const Camera& camera = view > 0 ? info_of(view).camera : info.camera;
      c.orthographic[i] = camera.projection == Projection::kOrthographic ? 1 : 0;
      c.ray_scale_x[i] = (camera.right - camera.left) / float(info.width);
      c.ray_offset_x[i] = camera.left;
      c.ray_scale_y[i] = -(camera.top - camera.bottom) / float(info.height);
      c.ray_offset_y[i] = camera.top;
      c.scale_x[i] = float(info.width) / (camera.right - camera.left);
      c.offset_x[i] = -camera.left * c.scale_x[i];
      c.scale_y[i] = -float(info.height) / (camera.top - camera.bottom);
      c.offset_y[i] = -camera.top * c.scale_y[i];
      const glm::mat4 move = camera.view_from_world * glm::inverse(info.camera.view_from_world);
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) c.move[12 * i + 4 * row + column] = move[column][row];
    }
  // Unused entries equal the first one, so that with a single layer a GPU can compile the value into its shader.
  for (int i = c.layer_count; i < kLayersRead; ++i) {
    c.new_view[i] = 1;
    c.orthographic[i] = c.orthographic[0];
  }
}

}  // namespace umbrage
