// The parameters, inputs and outputs of jobs, and the C functions of jobs.
#include "library/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/suggest.h"
#include "library/shared.h"
#include "renderer/passes.h"

namespace umbrage {
namespace {

/// Returns whether the field is text that is not a length.
bool is_word(const Option& row) {
  return std::holds_alternative<FieldOf<std::string>>(row.where) && row.form != OptionForm::kLength;
}

std::string number_text(std::span<const double> numbers) {
  std::string text;
  for (const double number : numbers)
    text += (text.empty() ? "" : ",") +
            (double(float(number)) == number ? fmt::format("{:.9g}", number) : fmt::format("{}", number));
  return text;
}

Result<void> set_row(const Option& row, std::span<const double> numbers, Request& request) {
  if (is_word(row) || numbers.empty())
    return field_error(row.field, numbers.empty() ? "no numbers" : number_text(numbers), "`{}` takes a string, not {}");
  if (std::holds_alternative<FieldOf<bool>>(row.where)) return field_error(row.field, "", "`{}` takes true or false");
  if (row.form == OptionForm::kSize || row.field == "height") {  // width or height
    if (numbers.size() != 1 || numbers[0] != std::floor(numbers[0]) || std::abs(numbers[0]) > 1e9)
      return field_error(row.field, "", "`{}` takes an integer");
    std::get<FieldOf<int>>(row.where)(request) = int(numbers[0]);
    return check_option(row, request);
  }
  return set_option(row, number_text(numbers) + (row.form == OptionForm::kPercent ? "%" : ""), request);
}

Result<void> set_row(const Option& row, const std::string& text, Request& request) {
  const auto side = row.form == OptionForm::kSize || row.field == "height" ? parse_number(text) : std::nullopt;
  return side ? set_row(row, std::array{*side}, request) : set_option(row, text, request);
}

/// Checks an assignment to an effect's parameter. Errors: kUsage.
Result<void> check_setting(const std::string& assignment) {
  EffectSettings settings = initial_settings(external_effects());
  return apply_setting(settings, assignment, external_effects());
}

}  // namespace

bool is_parameter(const Option& row, std::string_view owner) {
  if (std::holds_alternative<std::monostate>(row.where) || row.group == "Device") return false;
  if (owner == "scene") return row.group == "Scene" || row.field == "color_by";  // models are read with that field
  if (row.group == "Scene" || row.field == "model" || row.field == "settings" || row.field == "passes") return false;
  return owner == "render" ? row.group != "G-buffer" && row.group != "Files"
                           : (row.commands & kShade) != 0 || row.field == "strokes";
}

const Option* find_parameter(std::string_view name, std::string_view owner) {
  const Option* row = find_field(name);
  return row && is_parameter(*row, owner) ? row : nullptr;
}

Error unknown_parameter(const std::string& name, std::string_view owner) {
  std::vector<std::string_view> names;
  for (const Option& row : options())
    if (is_parameter(row, owner)) names.push_back(row.field);
  return unknown_name("parameter", name, names);
}

std::string JobObject::memory_purpose(const char*) const {
  const Request request = full_request();
  return fmt::format("a picture of {} x {} pixels", request.width, request.height);
}

Result<void> JobObject::set(const std::string& name, const std::string& text) {
  if (text.empty()) return reset(name.c_str());
  if (const Option* row = find_parameter(name, kind())) {
    Request changed = request_;
    reset_option(*row, changed);  // a list that is set again
    if (auto set = set_row(*row, text, changed); !set) return set;
    request_ = std::move(changed);
    return {};
  }
  const std::string owner = name.substr(0, name.find('.'));
  if (owner == name || owner == "camera") return unknown_parameter(name, kind());
  if (auto status = check_setting(name + "=" + text); !status) return status;
  settings_[name] = text;
  return {};
}

Result<void> JobObject::set(const std::string& name, std::span<const double> numbers) {
  const Option* row = find_parameter(name, kind());
  if (!row) {
    const auto setting = parse_setting(name + "=", external_effects());
    const ParameterType type = setting ? setting->parameter->type : ParameterType::kReal;
    if (type == ParameterType::kBool || type == ParameterType::kChoice)
      return field_error(name, number_text(numbers), "`{0}` takes {2}, not {1}",
                         type == ParameterType::kBool ? "true or false" : "a string");
    return set(name, number_text(numbers));
  }
  Request changed = request_;
  if (auto set = set_row(*row, numbers, changed); !set) return set;
  request_ = std::move(changed);
  return {};
}

Result<void> JobObject::set(const std::string& name, bool value) {
  const Option* row = find_parameter(name, kind());
  if (row && !std::holds_alternative<FieldOf<bool>>(row->where))
    return field_error(row->field, value, "`{}` cannot be {}: it does not take true or false");
  return set(name, std::string(value ? "true" : "false"));
}

Result<void> JobObject::reset(const char* name) {
  if (!name) {
    request_ = {};
    settings_.clear();
    return {};
  }
  if (const Option* row = find_parameter(name, kind())) {
    reset_option(*row, request_);
    return {};
  }
  if (settings_.erase(name) > 0) return {};
  // A setting that is not set needs no reset, but its name must exist.
  const auto setting = parse_setting(std::string(name) + "=", external_effects());
  return setting ? Result<void>() : unknown_parameter(name, kind());
}

Result<void> JobObject::set_image(const std::string& name, const UmbImage* image) {
  if (renders()) return usage_error("a job that renders a scene takes no image '{}'", name);
  std::optional<SharedImage> shared;
  if (image) {
    const auto channels = channels_of(name);
    if (channels.empty()) return unknown_image(name);
    UmbImage completed = *image;
    if (completed.channels == 0) completed.channels = int(channels.size());
    auto checked = shared_image("the image '" + name + "'", completed);
    if (!checked) return checked.error();
    if (!checked->data) return usage_error("the image '{}' has no values", name);
    shared = *checked;
  }
  std::erase_if(images_, [&](const NamedImage& named) { return named.name == name; });
  if (shared) images_.push_back({name, *shared});
  return {};
}

Result<void> JobObject::set_output(const std::string& name, const UmbImage* image) {
  if (name != "color" && name != "all" && channels_of(name).empty()) return unknown_image(name);
  std::optional<SharedImage> shared;
  if (image && image->data) {
    if (name == "all")
      return usage_error("the output 'all' cannot use the caller's memory: it stands for several images");
    UmbImage completed = *image;
    if (completed.channels == 0) completed.channels = umbGetPassChannels(name.c_str());
    auto checked = shared_image("the output '" + name + "'", completed);
    if (!checked) return checked.error();
    if (overlaps_itself(*checked)) return usage_error("pixels of the output '{}' share memory with each other", name);
    for (const Output& other : outputs_)
      if (other.pass != name && overlap(*checked, other.image))
        return usage_error("the outputs '{}' and '{}' share memory", name, other.pass);
    shared = *checked;
  }
  PixelType own_type = PixelType::kFloat32;
  if (image && !image->data && image->type != 0) {
    const auto type = pixel_type(image->type);
    if (!type) return type.error();
    if (*type == PixelType::kUint32 && !is_id(name))
      return usage_error("the output '{}' cannot hold 32-bit integers: only ids can", name);
    own_type = *type;
  }
  std::erase_if(outputs_, [&](const Output& output) { return output.pass == name; });
  if (image)
    outputs_.push_back({.pass = name, .image = shared.value_or(SharedImage()), .own = {}, .own_type = own_type});
  return {};
}

Result<UmbImage> JobObject::output(const std::string& name) const {
  for (const Output& output : results_)
    if (output.pass == name) return as_umb(output.image);
  return usage_error("the last execution produced no '{}'", name);
}

const char* JobObject::output_name(int index) const {
  return index >= 0 && std::size_t(index) < results_.size() ? results_[std::size_t(index)].pass.c_str() : nullptr;
}

}  // namespace umbrage

using namespace umbrage;  // for the C functions below

namespace {

Result<std::shared_ptr<Object>> new_job(UmbDevice device, UmbScene scene, bool renders) {
  auto device_object = object_of<DeviceObject>(device);
  if (!device_object) return usage_error("a job needs a device: it is NULL, or was released");
  auto scene_object = object_of<SceneObject>(scene);
  if (renders && !scene_object) return usage_error("a render job needs a scene: it is NULL, or was released");
  return std::shared_ptr<Object>(std::make_shared<JobObject>(std::move(device_object), std::move(scene_object)));
}

/// Sets a parameter from text, numbers or a flag.
template <class Value>
UmbError set_parameter(UmbJob job, const char* call, const char* name, const Value& value) {
  return call_on<JobObject>(job, call, Use::kChanges,
                            [&](JobObject& object) { return object.set(text_of(name), value); });
}

/// Returns a text of a list of the job; NULL beyond the last one.
template <class Texts>
const char* text_at(UmbJob job, int index, const Texts& texts) {
  const char* none = nullptr;
  return read_of<JobObject>(job, none, [&](const JobObject& object) {
    const std::vector<std::string>& all = texts(object);
    return index >= 0 && std::size_t(index) < all.size() ? all[std::size_t(index)].c_str() : none;
  });
}

/// Sets a parameter from numbers.
template <class Number>
UmbError set_numbers(UmbJob job, const char* call, const char* name, const Number* values, int count) {
  return call_on<JobObject>(job, call, Use::kChanges, [&](JobObject& object) -> Result<void> {
    if (!values || count < 1) return field_error(text_of(name), "", "`{}` has no values");
    return object.set(text_of(name), std::vector<double>(values, values + count));
  });
}

}  // namespace

UmbJob umbNewRenderJob(UmbDevice device, UmbScene scene) {
  return make_object<UmbJob>("umbNewRenderJob", [&] { return new_job(device, scene, true); });
}

UmbJob umbNewShadeJob(UmbDevice device) {
  return make_object<UmbJob>("umbNewShadeJob", [&] { return new_job(device, nullptr, false); });
}

void umbRetainJob(UmbJob job) { retain_object<JobObject>(job); }
void umbReleaseJob(UmbJob job) { release_object<JobObject>(job); }

UmbError umbGetJobError(UmbJob job, const char** message) { return take_error<JobObject>(job, message); }

UmbError umbSetJobProgressCallback(UmbJob job, UmbProgressCallback callback, void* user) {
  return set_progress<JobObject>(job, "umbSetJobProgressCallback", callback, user);
}

UmbError umbSetJobString(UmbJob job, const char* name, const char* value) {
  return set_parameter(job, "umbSetJobString", name, text_of(value));
}

UmbError umbSetJobBool(UmbJob job, const char* name, bool value) {
  return set_parameter(job, "umbSetJobBool", name, value);
}

UmbError umbSetJobInt(UmbJob job, const char* name, int value) {
  return set_numbers(job, "umbSetJobInt", name, &value, 1);
}

UmbError umbSetJobFloat(UmbJob job, const char* name, float value) {
  return set_numbers(job, "umbSetJobFloat", name, &value, 1);
}

UmbError umbSetJobFloats(UmbJob job, const char* name, const float* values, int count) {
  return set_numbers(job, "umbSetJobFloats", name, values, count);
}

UmbError umbSetJobDoubles(UmbJob job, const char* name, const double* values, int count) {
  return set_numbers(job, "umbSetJobDoubles", name, values, count);
}

UmbError umbResetJobParameter(UmbJob job, const char* name) {
  return call_on<JobObject>(job, "umbResetJobParameter", Use::kChanges,
                            [&](JobObject& object) { return object.reset(name); });
}

UmbError umbSetJobImage(UmbJob job, const char* name, const UmbImage* image) {
  return call_on<JobObject>(job, "umbSetJobImage", Use::kChanges,
                            [&](JobObject& object) { return object.set_image(text_of(name), image); });
}

UmbError umbSetJobOutput(UmbJob job, const char* name, const UmbImage* image) {
  return call_on<JobObject>(job, "umbSetJobOutput", Use::kChanges,
                            [&](JobObject& object) { return object.set_output(text_of(name), image); });
}

UmbError umbCheckJob(UmbJob job) {
  return call_on<JobObject>(job, "umbCheckJob", Use::kReads, [](JobObject& object) { return object.check(); });
}

UmbError umbPrepareJob(UmbJob job) {
  return call_on<JobObject>(job, "umbPrepareJob", Use::kChanges, [](JobObject& object) { return object.prepare(); });
}

UmbError umbExecuteJob(UmbJob job) {
  return call_on<JobObject>(job, "umbExecuteJob", Use::kChanges, [](JobObject& object) { return object.execute(); });
}

UmbError umbGetJobOutput(UmbJob job, const char* name, UmbImage* image) {
  return call_on<JobObject>(job, "umbGetJobOutput", Use::kReads, [&](JobObject& object) -> Result<void> {
    const auto output = object.output(text_of(name));
    if (!output) return output.error();
    if (!image) return usage_error("umbGetJobOutput: image cannot be NULL");
    *image = *output;
    return {};
  });
}

const char* umbGetJobOutputName(UmbJob job, int index) {
  const char* none = nullptr;
  return read_of<JobObject>(job, none, [&](const JobObject& object) { return object.output_name(index); });
}

size_t umbGetJobStrokeCount(UmbJob job) {
  return read_of<JobObject>(job, std::size_t(0), [](const JobObject& object) { return object.strokes.strokes.size(); });
}

UmbError umbGetJobStroke(UmbJob job, size_t index, UmbStroke* stroke) {
  return call_on<JobObject>(job, "umbGetJobStroke", Use::kReads, [&](JobObject& object) -> Result<void> {
    const auto& strokes = object.strokes.strokes;
    if (index >= strokes.size() || !stroke)
      return usage_error("there is no stroke {}: the last execution produced {}", index, strokes.size());
    const Stroke& from = strokes[index];
    static_assert(sizeof(StrokePoint) == sizeof(UmbStrokePoint));
    *stroke = {reinterpret_cast<const UmbStrokePoint*>(from.points.data()), from.points.size(), int32_t(from.kind),
               uint32_t(from.object), from.closed ? 1 : 0};
    return {};
  });
}

UmbError umbGetJobStrokeColor(UmbJob job, float rgb[3], float* opacity) {
  return call_on<JobObject>(job, "umbGetJobStrokeColor", Use::kReads, [&](JobObject& object) -> Result<void> {
    if (!rgb || !opacity) return usage_error("umbGetJobStrokeColor: rgb and opacity cannot be NULL");
    std::copy_n(object.stroke_color.begin(), 3, rgb);
    *opacity = object.stroke_opacity;
    return {};
  });
}

UmbError umbGetJobView(UmbJob job, UmbView* view) {
  return call_on<JobObject>(job, "umbGetJobView", Use::kReads, [&](JobObject& object) -> Result<void> {
    if (!view) return usage_error("umbGetJobView: view cannot be NULL");
    if (!object.camera) return usage_error("umbGetJobView: the job has made no picture of a scene or of files");
    *view = view_of(*object.camera, object.origin);
    return {};
  });
}

const char* umbGetJobFact(UmbJob job, int index) {
  return text_at(
      job, index, [](const JobObject& object) -> const auto& { return object.facts.lines; });
}

const char* umbGetJobFileLayer(UmbJob job, int index) {
  return text_at(
      job, index, [](const JobObject& object) -> const auto& { return object.facts.layers; });
}

int64_t umbGetJobCounter(UmbJob job, const char* name) {
  const auto object = object_of<JobObject>(job);
  if (!object) return -1;
  const std::string_view which = name ? name : "";
  const Counters& counters = object->counters;
  if (which == "hierarchies_built") return counters.hierarchies_built;
  if (which == "captures_made") return counters.captures_made;
  if (which == "planes_copied") return counters.planes_copied;
  return -1;
}
