// Calls on jobs, and checks of their outputs.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "caller.h"

namespace umbrage::fuzz {

void Caller::set_parameter() {
  JobState& job = pick(jobs_);
  const UmbJob handle = handle_of(job.ref);
  const ListedParameter& parameter = choose_.one_of(words().parameters);
  const Text name = choose_.one_in(16) ? any_odd(choose_) : Text(parameter.name);
  const bool is_size = parameter.name == "width" || parameter.name == "height";
  UmbError code = UMB_ERROR_NONE;
  switch (choose_.below(8)) {
    case 0: {
      trace("umbSetJobBool", name.shown());
      code = umbSetJobBool(handle, name.get(), choose_.below(2));
      break;
    }
    case 1: {
      const int value = any_int();
      trace("umbSetJobInt", name.shown() + " " + std::to_string(value));
      code = umbSetJobInt(handle, name.get(), value);
      break;
    }
    case 2: {
      const float value = any_number(choose_);
      trace("umbSetJobFloat", name.shown() + " " + std::to_string(value));
      code = umbSetJobFloat(handle, name.get(), value);
      break;
    }
    case 3: {
      const int count = choose_.one_in(6) ? -int(choose_.below(3)) : 1 + int(choose_.below(9));
      std::vector<float> values(std::size_t(std::max(count, 0)));
      for (float& value : values) value = any_number(choose_);
      trace("umbSetJobFloats", name.shown());
      code = umbSetJobFloats(handle, name.get(), choose_.one_in(12) ? nullptr : values.data(), count);
      const std::vector<double> doubles(values.begin(), values.end());
      if (choose_.below(2)) code = umbSetJobDoubles(handle, name.get(), doubles.data(), count);
      break;
    }
    case 4:
      trace("umbResetJobParameter", name.shown());
      code = umbResetJobParameter(handle, choose_.one_in(12) ? nullptr : name.get());
      break;
    default: {
      const Text value = is_size             ? Text(std::to_string(any_int()))
                         : choose_.one_in(9) ? any_odd(choose_)
                                             : Text(value_of(choose_, parameter));
      trace("umbSetJobString", name.shown() + " " + value.shown());
      code = umbSetJobString(handle, name.get(), value.get());
    }
  }
  done(code, Kind::kJob, handle, "a setter");
}

namespace {

/// Makes an image invalid.
void make_invalid(Choices& choose, int odd, UmbImage& image) {
  switch (choose.below(7)) {
    case 0:
      image.type = choose.below(2) ? 0 : 6;
      return;
    case 1:
      image.width = odd <= 0 || odd > 16384 ? odd : 0;
      return;
    case 2:
      image.height = odd <= 0 || odd > 16384 ? odd : -1;
      return;
    case 3:
      image.channels = choose.below(2) ? -1 : 65;
      return;
    case 4:
      image.row_stride = choose.below(2) ? PTRDIFF_MAX : PTRDIFF_MIN;
      return;
    case 5:
      image.pixel_stride = PTRDIFF_MIN;
      return;
    default:
      image.channel_stride = PTRDIFF_MAX;
  }
}

}  // namespace

void Caller::set_image() {
  JobState& job = pick(jobs_);
  const UmbJob handle = handle_of(job.ref);
  const bool is_depth = choose_.one_in(4);
  const Text name = is_depth ? Text("depth") : any_pass(choose_);
  const std::string key = name.get() ? name.get() : "";
  if (choose_.one_in(10)) {
    trace("umbSetJobImage", name.shown() + " NULL");
    if (done(umbSetJobImage(handle, name.get(), nullptr), Kind::kJob, handle, "umbSetJobImage") == UMB_ERROR_NONE &&
        handle == job.ref.handle && job.inputs.contains(key)) {
      retired_images_.push_back({{key, job.inputs[key]}});
      job.inputs.erase(key);
    }
    return;
  }
  const int known = umbGetPassChannels(name.get());
  const int channels = choose_.one_in(6) ? 1 + int(choose_.below(5)) : std::max(known, 1);
  const bool is_id = key.find("_id") != std::string::npos;
  const int type =
      choose_.below(3) ? is_id ? UMB_TYPE_UINT32 : UMB_TYPE_FLOAT32 : UMB_TYPE_FLOAT32 + int(choose_.below(5));
  const int width = choose_.one_in(16) ? 1 + int(choose_.below(40)) : job.width;
  const int height = choose_.one_in(16) ? 1 + int(choose_.below(40)) : job.height;
  Pixels pixels = is_depth && type == UMB_TYPE_FLOAT32 ? depth_image(choose_, width, height)
                                                       : valid_image(choose_, type, width, height, channels);
  UmbImage image = pixels.image;
  if (pixels.image.channels == known && choose_.one_in(4)) image.channels = 0;
  if (choose_.one_in(10)) make_invalid(choose_, any_int(), image);
  if (choose_.one_in(20)) image.data = nullptr;
  trace("umbSetJobImage", name.shown() + " " + std::to_string(width) + " x " + std::to_string(height));
  if (done(umbSetJobImage(handle, name.get(), &image), Kind::kJob, handle, "umbSetJobImage") != UMB_ERROR_NONE) return;
  demand(handle == job.ref.handle && job.ref.references > 0, "an image was set on an invalid job");
  retired_images_.push_back({{key, job.inputs[key]}});
  job.inputs[key] = pixels;
}

void Caller::set_output() {
  JobState& job = pick(jobs_);
  const UmbJob handle = handle_of(job.ref);
  const Text name = choose_.one_in(4) ? Text("color") : any_pass(choose_);
  const std::string key = name.get() ? name.get() : "";
  Pixels pixels;
  const unsigned option = choose_.below(8);
  if (option > 2) {
    const int known = umbGetPassChannels(name.get());
    const int channels = choose_.one_in(8) ? 1 + int(choose_.below(5)) : std::max(known, 1);
    const bool is_id = key.find("_id") != std::string::npos;
    int type = UMB_TYPE_FLOAT32 + int(choose_.below(5));
    if (type == UMB_TYPE_UINT32 && !is_id && !choose_.one_in(4)) type = UMB_TYPE_FLOAT32;
    const int width = choose_.one_in(16) ? 1 + int(choose_.below(40)) : job.width;
    pixels = valid_image(choose_, type, width, job.height, channels);
    const Pixels* other = job.outputs.empty() ? nullptr : &job.outputs.begin()->second;
    if (choose_.one_in(8) && other && other->block && other->block->size() >= pixels.block->size()) {
      // Use the memory of another output.
      const std::ptrdiff_t first = static_cast<std::byte*>(pixels.image.data) - pixels.block->data();
      pixels.block = other->block;
      pixels.image.data = pixels.block->data() + first;
    }
  }
  UmbImage image = pixels.image;
  if (pixels.block && pixels.image.channels == umbGetPassChannels(name.get()) && choose_.one_in(4)) image.channels = 0;
  if (pixels.block && choose_.one_in(12)) make_invalid(choose_, any_int(), image);
  trace("umbSetJobOutput", name.shown() + (option == 0 ? " NULL" : pixels.block ? " theirs" : " own"));
  if (done(umbSetJobOutput(handle, name.get(), option == 0 ? nullptr : &image), Kind::kJob, handle,
           "umbSetJobOutput") != UMB_ERROR_NONE)
    return;
  demand(handle == job.ref.handle && job.ref.references > 0, "an output was set on an invalid job");
  if (job.outputs.contains(key)) retired_images_.push_back({{key, job.outputs[key]}});
  job.outputs.erase(key);
  if (option != 0) job.outputs[key] = pixels;
}

void Caller::make_executable(JobState& job) {
  const UmbJob handle = job.ref.handle;
  if (job.ref.references == 0) return;
  trace("umbResetJobParameter", "and what else may be wrong");
  umbResetJobParameter(handle, nullptr);
  for (const auto& [name, pixels] : job.outputs) umbSetJobOutput(handle, name.c_str(), nullptr);
  retired_images_.push_back(std::exchange(job.outputs, {}));
  if (job.renders) {
    umbSetJobInt(handle, "width", job.width);
    umbSetJobInt(handle, "height", job.height);
  } else {
    for (const auto& [name, pixels] : job.inputs) umbSetJobImage(handle, name.c_str(), nullptr);
    retired_images_.push_back(std::exchange(job.inputs, {}));
    Pixels depth = depth_image(choose_, job.width, job.height);
    if (umbSetJobImage(handle, "depth", &depth.image) == UMB_ERROR_NONE) job.inputs["depth"] = depth;
  }
  umbGetJobError(handle, nullptr);
}

void Caller::execute(JobState& job) {
  const UmbJob handle = handle_of(job.ref);
  const NamedPixels inputs = job.inputs;
  NamedPixels outputs = job.outputs;
  std::vector<std::uint64_t> before;
  for (const auto& [name, pixels] : inputs) before.push_back(hash_of(*pixels.block));
  for (auto& [name, pixels] : outputs) fill_with_canaries(pixels, kCanary);
  const bool prepares = choose_.one_in(12);
  trace(prepares ? "umbPrepareJob" : "umbExecuteJob");
  begin_progress();
  const long executions = job.executions;
  const UmbError code = prepares ? umbPrepareJob(handle) : umbExecuteJob(handle);
  demand(Clock::now() - start_ < kMaxCallTime, "a job takes too long to be cancelled");
  done(code, Kind::kJob, handle, "umbExecuteJob");
  std::size_t number = 0;
  for (const auto& [name, pixels] : inputs) demand(hash_of(*pixels.block) == before[number++], "an input was written");
  if (job.executions != executions) return;  // a callback has executed the job too
  if (code == UMB_ERROR_USAGE && depth_ == 0 && choose_.below(2)) make_executable(job);
  if (prepares || code != UMB_ERROR_NONE) {
    for (const auto& [name, pixels] : outputs)
      demand(!pixels.block || code == UMB_ERROR_DEVICE || is_untouched(*pixels.block, kCanary),
             "a failing execution has written the output " + name);
    return;
  }
  ++counts.executed;
  ++job.executions;
  check_written(handle, outputs);
  if (job.ref.references > 0) read_outputs(handle);  // a callback may have released it
}

void Caller::check_written(UmbJob handle, NamedPixels& outputs) {
  std::map<std::string, std::vector<std::size_t>> doubtful;  // indices of values that may be correct or not written
  for (auto& [name, pixels] : outputs) {
    if (!pixels.block) continue;
    demand(is_untouched_outside(outputs, pixels.block, kCanary),
           "an execution has written beside the pixels of " + name);
    auto unwritten = indices_of_canaries(pixels, kCanary);
    const bool small = pixels.image.type == UMB_TYPE_UINT8 || pixels.image.type == UMB_TYPE_UINT16;
    demand(small || unwritten.empty(), "an execution has not written all pixels of " + name);
    if (!unwritten.empty()) doubtful[name] = std::move(unwritten);
  }
  if (doubtful.empty() || depth_ > 0) return;
  for (auto& [name, pixels] : outputs) fill_with_canaries(pixels, kOtherCanary);
  umbSetJobProgressCallback(handle, nullptr, nullptr);
  const UmbError code = umbExecuteJob(handle);
  umbSetJobProgressCallback(handle, on_progress, nullptr);
  if (done(code, Kind::kJob, handle, "umbExecuteJob, again") != UMB_ERROR_NONE) return;
  for (const auto& [name, numbers] : doubtful) {
    const auto unwritten = indices_of_canaries(outputs[name], kOtherCanary);
    std::vector<std::size_t> never_written;
    std::set_intersection(unwritten.begin(), unwritten.end(), numbers.begin(), numbers.end(),
                          std::back_inserter(never_written));
    demand(never_written.empty(), "an execution has not written all pixels of " + name);
  }
}

void Caller::read_outputs(UmbJob handle) {
  std::uint64_t sum = 0;
  int count = 0;
  for (const char* name = nullptr; (name = umbGetJobOutputName(handle, count)); ++count) {
    UmbImage image{};
    if (done(umbGetJobOutput(handle, name, &image), Kind::kJob, handle, "umbGetJobOutput") != UMB_ERROR_NONE) return;
    demand(image.data && image.width > 0 && image.height > 0 && image.channels > 0, "an output that is not an image");
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < image.channels; ++c)
          sum += std::uint64_t(*(static_cast<const std::byte*>(image.data) + y * image.row_stride +
                                 x * image.pixel_stride + c * image.channel_stride));
  }
  demand(count > 0, "an execution produced no output");
  const std::size_t strokes = umbGetJobStrokeCount(handle);
  for (std::size_t k = 0; k < strokes; ++k) {
    UmbStroke stroke{};
    if (done(umbGetJobStroke(handle, k, &stroke), Kind::kJob, handle, "umbGetJobStroke") != UMB_ERROR_NONE) return;
    for (std::size_t p = 0; p < stroke.point_count; ++p)
      demand(std::isfinite(stroke.points[p].x + stroke.points[p].y + stroke.points[p].width),
             "a stroke's point that is not finite");
  }
  demand(sum != ~std::uint64_t(0), "an impossible sum");  // uses the sum, so that all bytes are read
}

void Caller::query_job() {
  const JobState& job = pick(jobs_);
  const UmbJob handle = handle_of(job.ref);
  const Text name = any_pass(choose_);
  trace("umbCheckJob, umbGetJob...", name.shown());
  done(umbCheckJob(handle), Kind::kJob, handle, "umbCheckJob");
  UmbImage image{};
  done(umbGetJobOutput(handle, name.get(), choose_.one_in(4) ? nullptr : &image), Kind::kJob, handle,
       "umbGetJobOutput");
  umbGetJobOutputName(handle, any_int());
  umbGetJobFact(handle, any_int());
  umbGetJobFileLayer(handle, any_int());
  UmbStroke stroke{};
  done(umbGetJobStroke(handle, std::size_t(any_int()), choose_.one_in(4) ? nullptr : &stroke), Kind::kJob, handle,
       "umbGetJobStroke");
  float color[4] = {};
  UmbView view{};
  done(umbGetJobView(handle, choose_.one_in(4) ? nullptr : &view), Kind::kJob, handle, "umbGetJobView");
  done(umbGetJobStrokeColor(handle, choose_.one_in(4) ? nullptr : color, color + 3), Kind::kJob, handle,
       "umbGetJobStrokeColor");
  for (const char* counter : {"hierarchies_built", "captures_made", "planes_copied"})
    demand(umbGetJobCounter(handle, counter) >= (job.ref.references > 0 && handle == job.ref.handle ? 0 : -1), counter);
  demand(umbGetJobCounter(handle, choose_.below(2) ? nullptr : "x") == -1, "a counter that does not exist");
}

void Caller::write_files() {
  static const std::string kFolder = std::filesystem::temp_directory_path().string() + "/umbrage_calls_" +
                                     std::to_string(std::size_t(Clock::now().time_since_epoch().count()));
  static const std::vector<const char*> kEnds = {".png", ".pfm", ".exr", ".jpg", ".webp", ".svg", "", "/none/x.png"};
  const std::string file = kFolder + choose_.one_of(kEnds);
  const int count = choose_.one_in(8) ? -1 : int(choose_.below(4));
  std::vector<Pixels> pixels;
  std::vector<Text> texts;
  std::vector<const char*> names;
  std::vector<UmbImage> images;
  for (int k = 0; k < count; ++k) {
    pixels.push_back(valid_image(choose_, 1 + int(choose_.below(5)), 9, 7, 1 + int(choose_.below(5))));
    texts.push_back(any_pass(choose_));
    images.push_back(pixels.back().image);
    if (choose_.one_in(12)) make_invalid(choose_, any_int(), images.back());
    if (choose_.one_in(20)) images.back().data = nullptr;
  }
  names.reserve(texts.size());
  for (const Text& text : texts) names.push_back(text.get());
  trace("umbWriteImages", file);
  done(umbWriteImages(choose_.one_in(12) ? nullptr : file.c_str(), choose_.one_in(12) ? nullptr : names.data(),
                      images.data(), count, choose_.one_in(4) ? any_int() : 8 + 8 * int(choose_.below(2)),
                      choose_.below(2)),
       Kind::kNone, nullptr, "umbWriteImages");
  UmbView view{{1, 0, 0, any_number(choose_), 0, 1, 0, 0, 0, 0, 1, 0}, -1, any_number(choose_), -1, 1, 0};
  trace("umbWriteImagesOfView", file);
  done(umbWriteImagesOfView(file.c_str(), names.data(), images.data(), count, 8, choose_.below(2),
                            choose_.one_in(3) ? nullptr : &view),
       Kind::kNone, nullptr, "umbWriteImagesOfView");
  std::vector<UmbStrokePoint> points(choose_.below(4));
  for (UmbStrokePoint& point : points) point = {any_number(choose_), any_number(choose_), any_number(choose_)};
  const std::vector<UmbStroke> strokes = {{points.data(), points.size(), int(choose_.below(4)), 1, 0},
                                          {nullptr, choose_.below(2), 0, 1, 1}};
  const float rgb[3] = {any_number(choose_), 0.5f, 1.0f};
  trace("umbWriteStrokes", file);
  done(umbWriteStrokes(file.c_str(), any_int(), any_int(), choose_.one_in(8) ? nullptr : strokes.data(),
                       choose_.below(3), choose_.one_in(8) ? nullptr : rgb, any_number(choose_)),
       Kind::kNone, nullptr, "umbWriteStrokes");
  std::error_code ignored;
  for (const char* end : kEnds) std::filesystem::remove(kFolder + end, ignored);
}

void Caller::query_lists() {
  const int list = 1 + int(choose_.below(6));
  trace("umbGetListEntry", std::to_string(list));
  const char *name = nullptr, *summary = nullptr;
  if (list != UMB_LIST_DEVICES) {  // the list of devices loads drivers
    if (umbGetListEntry(UmbList(list), any_int(), choose_.one_in(4) ? nullptr : &name, &summary) == UMB_ERROR_NONE)
      demand(summary && *summary, "an entry without a summary");
  }
  umbGetListEntry(UmbList(choose_.below(2) ? 0 : 7), 0, &name, &summary);
  UmbParameter parameter{};
  parameter.size = std::size_t(choose_.one_in(4) ? choose_.below(sizeof parameter) : int(sizeof parameter));
  const Text owner = choose_.below(2) ? any_odd(choose_) : Text(choose_.one_of(words().effects));
  umbGetParameter(owner.get(), any_int(), choose_.one_in(4) ? nullptr : &parameter);
  demand(umbGetPassChannels(owner.get()) >= 0, "a pass with a negative number of channels");
  umbGetError(choose_.below(2) ? nullptr : &name);
}

}  // namespace umbrage::fuzz
