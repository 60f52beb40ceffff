// Names are in small letters without blanks, underscores and hyphens.
#include "gbuffers/roles.h"

#include <vector>

namespace umbrage {
namespace {

/// Names of depth layers, the preferred first: exact depth before depth for a denoiser, planar before ray distance.
constexpr DepthName kDepthNames[] = {
    {"depth"},
    {"z"},
    {"depth.z"},
    {"distancetoimageplane", DepthHint::kPlanar},
    {"distancetoimageplanesd", DepthHint::kPlanar},
    {"rayhitpz", DepthHint::kPlanar},
    {"hitpz", DepthHint::kPlanar},
    {"scenedepth", DepthHint::kPlanar},
    {"scenedepthworldunits", DepthHint::kPlanar},
    {"worlddepth", DepthHint::kPlanar},
    {"lineardepth"},
    {"cameradepth"},
    {"zdepth"},
    {"zbuffer"},
    {"distancetocamera", DepthHint::kDistance},
    {"distancetocamerasd", DepthHint::kDistance},
    {"denoisingdepth", DepthHint::kDistance},
    {"distance", DepthHint::kDistance},
    {"raydepth", DepthHint::kDistance},
    {"raylength", DepthHint::kDistance},
    {"hitdist", DepthHint::kDistance},
    {"rayhitdist", DepthHint::kDistance},
    {"vrayzdepth", DepthHint::kGrey},
    {"depthsd", DepthHint::kReversed},
    {"windowdepth", DepthHint::kWindow},
    {"depthbuffer", DepthHint::kWindow},
    {"disparity", DepthHint::kDisparity},
    {"disp", DepthHint::kDisparity},
    {"inversedepth", DepthHint::kDisparity},
    {"invdepth", DepthHint::kDisparity},
    {"height", DepthHint::kHeight},
    {"elevation", DepthHint::kHeight},
    {"dem", DepthHint::kHeight},
};

constexpr std::string_view kNormalNames[] = {"normal",         "n",
                                             "normals",        "ncamera",
                                             "n.camera",       "nworld",
                                             "n.world",        "nn",
                                             "shnormal",       "ns",
                                             "worldnormal",    "normalworld",
                                             "cameranormal",   "normalcamera",
                                             "vraynormals",    "normalsd",
                                             "shadingnormal",  "smoothnormal",
                                             "visiblenormals", "denoisingnormal",
                                             "optixnormals",   "geonormal",
                                             "denoisenormal",  "vraybumpnormals",
                                             "bumpnormals"};
constexpr std::string_view kPositionNames[] = {
    "position",      "p",     "positions",     "pworld",   "p.world",       "pcamera",    "p.camera",
    "worldposition", "wp",    "positionworld", "worldpos", "pointposition", "pointworld", "points",
    "pointmap",      "pts3d", "worldpoints",   "xyz"};
constexpr std::string_view kAlbedoNames[] = {"albedo",        "diffusealbedo",     "diffcol",       "diffusecolor",
                                             "basecolor",     "vraydiffusefilter", "diffusefilter", "visiblealbedo",
                                             "denoisealbedo", "denoisingalbedo",   "diffusesd",     "visiblediffuse",
                                             "diffuse"};
constexpr std::string_view kBeautyNames[] = {"combined", "beauty",    "rgba",       "rgb",       "c",
                                             "ci",       "color",     "hdrcolor",   "rgbcolor",  "ldrcolor",
                                             "image",    "composite", "hdrcolorsd", "noisyimage"};
constexpr std::string_view kAlphaNames[] = {"alpha", "opacity"};
constexpr std::string_view kIndirectNames[] = {"indirectdiffuse",        "diffuseindirect",    "diffind",
                                               "vrayglobalillumination", "globalillumination", "gi"};
/// Those of Cycles, whose indirect light is not multiplied by the albedo.
constexpr std::string_view kIndirectColorNames[] = {"diffcol", "diffusecolor"};
constexpr std::string_view kEmissionNames[] = {
    "emission", "emit", "emissive", "selfillum", "selfillumination", "vrayselfillumination"};
constexpr std::string_view kObjectIdNames[] = {"objectid",   "objectindex", "indexob",  "objid",
                                               "instanceid", "id",          "instance", "shapeindex"};
constexpr std::string_view kMaterialIdNames[] = {"materialid", "materialindex", "indexma", "matid"};

constexpr std::string_view kMaskNames[] = {"mask", "valid", "validmask", "validity"};

/// Planes that files of Umbrage have under their own names.
constexpr std::string_view kOwnNames[] = {"specular", "shininess", "metallic", "roughness", "material_ao",
                                          "shadow",   "shadow1",   "shadow2",  "shadow3",   "shadow4",
                                          "shadow5",  "shadow6",   "shadow7"};

}  // namespace

std::span<const DepthName> depth_names() { return kDepthNames; }

Names names_of(Role role) {
  switch (role) {
    case Role::kNormal:
      return kNormalNames;
    case Role::kPosition:
      return kPositionNames;
    case Role::kAlbedo:
      return kAlbedoNames;
    case Role::kBeauty:
      return kBeautyNames;
    case Role::kAlpha:
      return kAlphaNames;
    case Role::kIndirect:
      return kIndirectNames;
    case Role::kIndirectColor:
      return kIndirectColorNames;
    case Role::kEmission:
      return kEmissionNames;
    case Role::kObjectId:
      return kObjectIdNames;
    case Role::kMaterialId:
      return kMaterialIdNames;
    case Role::kMask:
      return kMaskNames;
    case Role::kOwn:
      return kOwnNames;
    case Role::kMotion:  // see find_motion
      return {};
    case Role::kDepth:
      break;
  }
  static const std::vector<std::string_view> depths = [] {
    std::vector<std::string_view> list;
    for (const DepthName& depth : kDepthNames) list.push_back(depth.name);
    return list;
  }();
  return depths;
}

}  // namespace umbrage
