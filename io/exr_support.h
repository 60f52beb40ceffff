// What the readers and writers of OpenEXR files have in common: names, the camera in headers, checked opening.
#pragma once
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>

#include "core/camera.h"
#include "core/check.h"
#include "core/result.h"

namespace umbrage {

/// An unfinished file is an error, not a picture with holes: the argument `reconstructChunkOffsetTable` of input files.
inline constexpr bool kNoRepair = false;

/// Returns the number of threads to use: `requested`, or all for 0; at most the number of the machine.
int exr_thread_count(int requested);

/// Returns the text after the last dot.
std::string_view last_word(std::string_view name);

/// Return the name of a plane in a file, and the name of a channel as a plane: see exr.cpp.
std::string exr_channel_of(std::string_view plane);
std::string exr_plane_of(std::string_view channel);

/// Returns the library's message without its first sentence, which repeats the file's name.
std::string exr_cause(const std::exception& exception);

/// Adds the attributes of a camera to a header. `view_from_world`: its view matrix in double precision, or null.
void add_camera(Imf::Header& header, const Camera& camera, const glm::dmat4* view_from_world);

/// Returns the camera in a header; nothing if it has none that Camera can represent. Throws the library's exceptions.
std::optional<Camera> camera_of(const Imf::Header& header);

/// Returns whether the first bytes of a file are those of an EXR file.
bool is_exr(std::string_view start);

/// Opens a file whose headers were checked: each window has at most kMaxFileSide pixels per side, and the file is not
/// too short for its pixels at the maximum compression. Throws the library's exceptions. Errors: kFile.
Result<std::unique_ptr<Imf::MultiPartInputFile>> open_exr(const std::filesystem::path& file);

/// Runs `work` and turns the library's exceptions into kFile errors that name the file. Memory that is missing, which
/// the callers for all formats turn into an error, and errors of our own are thrown on.
template <class Work>
auto catching_exr(const std::filesystem::path& file, Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const InternalError&) {
    throw;
  } catch (const std::exception& exception) {
    return file_error("'{}' cannot be read as EXR: {}", file.string(), exr_cause(exception));
  }
}

/// Checks the headers of an EXR file, open as `stream`, of `size` bytes. The library allocates whatever a damaged
/// header claims: up to 2 GB for an attribute, and tables for windows of any size. Errors: kFile, naming `file`.
Result<void> check_exr_headers(const std::filesystem::path& file, std::FILE* stream, std::int64_t size);

/// The matrices of a camera in OpenEXR's header. They transform columns (m * p), as in glm. Imath transforms rows and
/// stores rows, which gives the same 16 numbers.
struct ExrCamera {
  /// World to OpenEXR's camera space: left-handed, +x right, +y up, +z forward.
  glm::dmat4 camera_from_world{1.0};
  /// World to normalized device coordinates. After division by w, (0, 0) is the upper left corner of the display window
  /// and (1, 1) the lower right one. OpenEXR does not define z: here it is 1 - 1 / depth for perspective and depth for
  /// parallel cameras, so that the matrix is invertible.
  glm::dmat4 ndc_from_world{1.0};
};

/// Returns the matrices of a camera whose view matrix is `view_from_world`.
ExrCamera exr_camera(const Camera& camera, const glm::dmat4& view_from_world);
inline ExrCamera exr_camera(const Camera& camera) { return exr_camera(camera, glm::dmat4(camera.view_from_world)); }

/// Returns the camera that the two matrices describe, or nothing if they describe no pinhole or parallel camera that
/// Camera can represent.
std::optional<Camera> camera_from(const ExrCamera& matrices);

}  // namespace umbrage
