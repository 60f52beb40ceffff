// Shades one G-buffer and writes its picture.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>

#include "apps/cli/render_options.h"
#include "apps/cli/sequence.h"
#include "apps/cli/video.h"
#include "core/device.h"
#include "renderer/shade_file.h"
#include "renderer/steady_shading.h"

namespace umbrage::cli {

struct ShadeOptions : RenderOptions {
  std::string file;    ///< first word of the command line; empty: only separate files
  bool merge = false;  ///< the results become layers of a copy of the input
};

/// One picture of `umbrage shade`.
struct ShadeFrame {
  GBufferSettings gbuffer;             ///< with the files of this frame
  std::string output;                  ///< file to write; empty: none, for what later frames take from this one
  Video* video = nullptr;              ///< if not null, receives the picture
  double memory = 0.0;                 ///< bytes
  std::optional<SequenceStart> start;  ///< of the first frame
  SteadyShading* steady = nullptr;     ///< if not null, joins the frame with those around it
  int number = 0;                      ///< of the frame
  ProgressMonitor monitor = {};
  std::function<void(const GBufferFile&, const Recipe&)> opened = {};  ///< called before the picture is shaded
};

/// Returns the folder for temporary files of a picture that exceeds the memory: that of the output, which has space.
std::string scratch_folder(const std::string& output);

/// Checks what does not depend on the content of the files, and sets what follows from the format of the output.
/// Errors: kUsage; kFile if the output cannot be written.
Result<void> prepare_shading(ShadeOptions& o, const std::string& output);

/// Shades a picture and writes it. Returns what later frames take from it. Errors: kUsage; kFile; kInterrupted.
Result<SequenceStart> shade_frame(const ShadeOptions& o, const ShadeFrame& frame, Device& device, StageTimes& times);

/// The files of a G-buffer.
inline constexpr std::array kFileFields = {&GBufferSettings::file,        &GBufferSettings::depth_file,
                                           &GBufferSettings::normal_file, &GBufferSettings::albedo_file,
                                           &GBufferSettings::beauty_file, &GBufferSettings::position_file,
                                           &GBufferSettings::id_file,     &GBufferSettings::motion_file};

/// Returns the files of a sequence that frames read, by their numbers or all of them; `outputs` is empty. Errors:
/// kUsage.
Result<SequenceFiles> input_files(const GBufferSettings& settings);

/// Returns whether the settings name a sequence.
bool is_sequence(const GBufferSettings& settings);

/// Returns the settings of a frame: patterns replaced by its files.
GBufferSettings settings_of_frame(const GBufferSettings& settings, int frame);

/// Returns the path of "FILE" or "FILE:LAYER"; a file of the whole name has precedence.
std::string path_of(const std::string& name);

/// Returns the approximate memory that shading takes, with the planes as read, bytes.
Result<double> shading_bytes(const Device& device, const GBufferFile& file, const Recipe& recipe);

}  // namespace umbrage::cli
