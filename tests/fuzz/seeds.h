// Small sound files of every format, made in code.
#pragma once
#include <string>
#include <vector>

namespace umbrage::fuzz {

using Seeds = std::vector<std::string>;

Seeds ply_seeds();
Seeds off_seeds();
Seeds xyz_seeds();
Seeds radiance_seeds();
Seeds obj_seeds();
Seeds stl_seeds();
Seeds gltf_seeds();
Seeds glb_seeds();
Seeds seeds_of_3ds();
Seeds dae_seeds();
Seeds fbx_seeds();
Seeds png_seeds();
Seeds exr_seeds();
Seeds pfm_seeds();
Seeds texture_seeds();
Seeds setting_seeds();
Seeds scene_name_seeds();
Seeds transfer_seeds();
Seeds baseline_seeds();

}  // namespace umbrage::fuzz
