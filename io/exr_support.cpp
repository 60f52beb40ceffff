#include "io/exr_support.h"

#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <tbb/info.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "io/format.h"

namespace umbrage {

namespace fs = std::filesystem;
namespace {

constexpr std::string_view kColor = "color.";
constexpr std::string_view kDepth = "depth", kDepthEnding = ".Z";
constexpr std::string_view kSmallLetters = "rgbaxyz", kCapitals = "RGBAXYZ";

/// Returns the last letter if a dot precedes it, else 0.
char last_letter(std::string_view name) { return name.size() > 2 && name[name.size() - 2] == '.' ? name.back() : '\0'; }

/// Names of the attributes that hold the matrices in double precision, for worlds whose coordinates exceed the
/// precision of the standard attributes.
constexpr const char *kWorldToCameraDouble = "worldToCameraDouble", *kWorldToNdcDouble = "worldToNDCDouble";

template <class T>
Imath::Matrix44<T> imath(const glm::dmat4& m) {
  Imath::Matrix44<T> out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = T(m[i][j]);
  return out;
}

template <class T>
glm::dmat4 glm_from(const Imath::Matrix44<T>& m) {
  glm::dmat4 out;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out[i][j] = m[i][j];
  return out;
}

/// Returns the maximum compression ratio: 1032 for deflate, times 64 for the preceding run-length step of DWA and PIZ.
/// A file that is shorter than this ratio permits cannot contain the pixels that its header claims.
std::int64_t max_ratio(Imf::Compression compression) {
  constexpr std::int64_t kDeflate = 1032, kRuns = 64;
  const bool has_runs = compression == Imf::PIZ_COMPRESSION || compression == Imf::DWAA_COMPRESSION ||
                        compression == Imf::DWAB_COMPRESSION;
  return has_runs ? kDeflate * kRuns : kDeflate;
}

}  // namespace

int exr_thread_count(int requested) {
  const int max = tbb::info::default_concurrency();
  return requested > 0 ? std::min(requested, max) : max;
}

std::string_view last_word(std::string_view name) { return name.substr(name.rfind('.') + 1); }

std::string exr_channel_of(std::string_view plane) {
  std::string channel(plane);
  if (last_word(plane) == kDepth) return channel.append(kDepthEnding);
  const auto at = kSmallLetters.find(last_letter(plane));
  if (at == std::string_view::npos) return channel;
  channel.back() = kCapitals[at];
  return plane.size() == kColor.size() + 1 && plane.starts_with(kColor) && at < 4 ? channel.substr(kColor.size())
                                                                                  : channel;
}

std::string exr_plane_of(std::string_view channel) {
  if (channel.ends_with(kDepthEnding)) {
    const std::string_view before = channel.substr(0, channel.size() - kDepthEnding.size());
    if (last_word(before) == kDepth) return std::string(before);
  }
  if (channel.size() == 1 && kCapitals.substr(0, 4).find(channel[0]) != std::string_view::npos)
    return std::string(kColor) + kSmallLetters[kCapitals.find(channel[0])];
  std::string plane(channel);
  const auto at = kCapitals.find(last_letter(channel));
  if (at != std::string_view::npos) plane.back() = kSmallLetters[at];
  return plane;
}

std::string exr_cause(const std::exception& exception) {
  const std::string text = exception.what();
  const std::size_t end = text.find("\". ");
  return printable(end == std::string::npos ? text : text.substr(end + 3));
}

void add_camera(Imf::Header& header, const Camera& camera, const glm::dmat4* view_from_world) {
  const ExrCamera matrices =
      exr_camera(camera, view_from_world ? *view_from_world : glm::dmat4(camera.view_from_world));
  const Imath::M44f standard = imath<float>(matrices.camera_from_world);
  Imf::addWorldToCamera(header, standard);
  Imf::addWorldToNDC(header, imath<float>(matrices.ndc_from_world));
  if (glm_from(standard) != matrices.camera_from_world) {
    header.insert(kWorldToCameraDouble, Imf::M44dAttribute(imath<double>(matrices.camera_from_world)));
    header.insert(kWorldToNdcDouble, Imf::M44dAttribute(imath<double>(matrices.ndc_from_world)));
  }
  if (camera.projection != Projection::kPerspective) return;
  // OpenEXR's screen window is at distance 1, as in Camera.
  header.screenWindowWidth() = camera.right - camera.left;
  header.screenWindowCenter() = Imath::V2f((camera.left + camera.right) / 2, (camera.bottom + camera.top) / 2);
}

std::optional<Camera> camera_of(const Imf::Header& header) {
  if (!Imf::hasWorldToCamera(header) || !Imf::hasWorldToNDC(header)) return std::nullopt;
  const auto* exact_camera = header.findTypedAttribute<Imf::M44dAttribute>(kWorldToCameraDouble);
  const auto* exact_ndc = header.findTypedAttribute<Imf::M44dAttribute>(kWorldToNdcDouble);
  if (exact_camera && exact_ndc) return camera_from({glm_from(exact_camera->value()), glm_from(exact_ndc->value())});
  return camera_from({glm_from(Imf::worldToCamera(header)), glm_from(Imf::worldToNDC(header))});
}

bool is_exr(std::string_view start) { return start.starts_with("\x76\x2f\x31\x01"); }

Result<std::unique_ptr<Imf::MultiPartInputFile>> open_exr(const fs::path& file) {
  std::int64_t size = 0;
  const Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  if (auto status = check_exr_headers(file, stream->get(), size); !status) return status.error();
  auto input = std::make_unique<Imf::MultiPartInputFile>(file.c_str(), 0, kNoRepair);
  for (int part = 0; part < input->parts(); ++part) {
    const Imf::Header& header = input->header(part);
    for (const Imath::Box2i& window : {header.displayWindow(), header.dataWindow()}) {
      const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1,
                         height = std::int64_t(window.max.y) - window.min.y + 1;
      if (auto status = check_sides(file, width, height); !status) return status.error();
    }
    if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE) continue;
    const Imath::Box2i& data = header.dataWindow();
    const std::int64_t width = std::int64_t(data.max.x) - data.min.x + 1,
                       height = std::int64_t(data.max.y) - data.min.y + 1;
    std::int64_t bytes = 0;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
      const Imf::Channel& channel = it.channel();
      bytes += width / channel.xSampling * (height / channel.ySampling) * (channel.type == Imf::HALF ? 2 : 4);
    }
    if (bytes / max_ratio(header.compression()) > size)
      return file_error("'{}' is cut short: {} bytes cannot hold {} x {} pixels", file.string(), size, width, height);
  }
  return input;
}

namespace {

/// Tolerance of matrix elements. The matrices come from float attributes; inverting one of them adds to their error.
constexpr double kTolerance = 1e-3;

/// Returns the matrix with z flipped: Camera looks along -z of view space, OpenEXR's camera along +z.
glm::dmat4 with_z_flipped(glm::dmat4 m) {
  for (int i = 0; i < 4; ++i) m[i][2] = -m[i][2];
  return m;
}

bool is_rigid(const glm::dmat4& m) {
  const glm::dmat3 rotation(m);
  const glm::dmat3 product = glm::transpose(rotation) * rotation;
  double deviation = std::abs(m[0][3]) + std::abs(m[1][3]) + std::abs(m[2][3]) + std::abs(m[3][3] - 1.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) deviation += std::abs(product[i][j] - (i == j ? 1.0 : 0.0));
  return deviation <= kTolerance;  // false for NaN
}

}  // namespace

ExrCamera exr_camera(const Camera& camera, const glm::dmat4& view_from_world) {
  ExrCamera out;
  out.camera_from_world = with_z_flipped(view_from_world);
  const double width = double(camera.right) - camera.left, height = double(camera.top) - camera.bottom;
  // u and v follow from the camera's x, y and depth d. Perspective: u = (x / d - left) / width, v = (top - y / d) /
  // height.
  glm::dmat4 ndc(0.0);
  ndc[0][0] = 1.0 / width;
  ndc[1][1] = -1.0 / height;
  ndc[2][2] = 1.0;
  const bool perspective = camera.projection == Projection::kPerspective;
  glm::dvec4& offset = ndc[perspective ? 2 : 3];
  offset[0] = -camera.left / width;
  offset[1] = camera.top / height;
  offset[3] = 1.0;
  if (perspective) ndc[3][2] = -1.0;
  out.ndc_from_world = ndc * out.camera_from_world;
  return out;
}

std::optional<Camera> camera_from(const ExrCamera& matrices) {
  if (!is_rigid(matrices.camera_from_world)) return std::nullopt;
  const glm::dmat4 ndc = matrices.ndc_from_world * glm::inverse(matrices.camera_from_world);
  // The columns of ndc are for the camera's x, y, depth and the constant 1; rows 0, 1 and 3 give u, v and w. w may
  // depend only on the depth (perspective) or only on the constant (parallel): on column `used`, which also holds the
  // offset of the window. u may depend on x and that column, v on y and that column. Column `other` must be zero.
  const bool perspective = std::abs(ndc[2][3]) > std::abs(ndc[3][3]);
  const int used = perspective ? 2 : 3, other = perspective ? 3 : 2;
  const double w = ndc[used][3];
  // Rounding errors of the constants grow with the distance from the world's origin.
  const double reach = 1.0 + glm::length(glm::dvec3(matrices.camera_from_world[3]));
  const double other_sum = std::abs(ndc[other][0]) + std::abs(ndc[other][1]) + std::abs(ndc[other][3]);
  const double error_sum = std::abs(ndc[0][3]) + std::abs(ndc[1][3]) + std::abs(ndc[1][0]) + std::abs(ndc[0][1]) +
                           (perspective ? other_sum / reach : other_sum);
  if (!(error_sum <= kTolerance * std::abs(w))) return std::nullopt;
  Camera camera;
  camera.view_from_world = glm::mat4(with_z_flipped(matrices.camera_from_world));
  camera.projection = perspective ? Projection::kPerspective : Projection::kOrthographic;
  camera.left = float(-ndc[used][0] / ndc[0][0]);
  camera.right = float((w - ndc[used][0]) / ndc[0][0]);
  camera.top = float(-ndc[used][1] / ndc[1][1]);
  camera.bottom = float((w - ndc[used][1]) / ndc[1][1]);
  const float width = camera.right - camera.left, height = camera.top - camera.bottom;
  if (!(width > 0.0f && height > 0.0f && std::isfinite(width) && std::isfinite(height))) return std::nullopt;
  return camera;
}

}  // namespace umbrage
