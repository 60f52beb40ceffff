// What a program needs: computes backwards how far from the pixels of a result each plane is read, and adds up the
// planes that live.
#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

#include "core/lists.h"
#include "effects/effects.h"
#include "program/program.h"

namespace umbrage {
namespace {

constexpr Margin kNotNeeded{-1, -1};

/// A plane as one pass wrote it, or as the frame has it at first.
struct Written {
  int plane = 0, pass = -1;
  bool operator==(const Written&) const = default;
};

/// A part of a program that reads planes and writes others: a dispatch, for example.
struct Pass {
  struct Read {
    Written from;
    Margin margin;  ///< around each pixel that the pass computes
  };
  std::vector<Read> reads;
  std::vector<int> writes;
  bool on_host = false;    ///< it computes whole planes from whole planes
  bool is_meter = false;   ///< in strips, it reads all rows once, and the next sweep has the result
  bool is_copy = false;    ///< of one plane, which may be missing, to another resolution
  int multiple_of_px = 1;  ///< it computes blocks of this many pixels, across and down
};

Margin larger(const Margin& a, const Margin& b) { return {std::max(a.rows, b.rows), std::max(a.columns, b.columns)}; }

int rounded_up(int value, int multiple) { return (value + multiple - 1) / multiple * multiple; }

/// Returns the margin of what a pass reads if it computes pixels with the margin `computed`.
Margin around(const Margin& computed, const Margin& read, int multiple) {
  return {std::min(rounded_up(computed.rows, multiple) + read.rows, kAnywhere),
          std::min(rounded_up(computed.columns, multiple) + read.columns, kAnywhere)};
}

/// The passes of a run.
class Passes {
 public:
  /// `given`: the planes that the frame has at first; empty: all.
  Passes(const LookRun& run, const PictureInfo& info, std::span<const EffectStep> before,
         std::optional<std::span<const std::string>> given)
      : run_(run), info_(info), given_(given) {
    plane("", 1);  // kComputed
    for (const EffectStep& step : before) add_effect({.effect = step.effect, .layer = step.layer}, step.params);
    const Program program = compile(run, 1 + int(info.more_layers.size()), &info);
    for (const Operation& operation : program.operations) add(program, operation);
  }

  /// Returns the margins that the planes of the frame need at first, so that after `end` passes planes have these.
  /// `wholes`: planes that exist as a whole, so that no row of them is computed.
  std::vector<Margin> before(std::size_t end, std::vector<Margin> needed, const std::vector<Written>& wholes) const {
    for (std::size_t k = end; k-- > 0;) {
      const Pass& pass = passes_[k];
      Margin computed = kNotNeeded;
      for (const int plane : pass.writes)
        if (!contains(wholes, Written{plane, int(k)})) computed = larger(computed, needed[std::size_t(plane)]);
      if (computed.rows < 0) continue;
      needed[kComputed] = larger(needed[kComputed], computed);
      for (const Pass::Read& read : pass.reads) {
        if (!exists(read.from)) continue;
        const bool is_given = read.from.pass < 0;  // rows of it are there, too
        if (contains(wholes, read.from) && (!is_given || read.margin.rows >= kAnywhere)) continue;
        Margin& of_input = needed[std::size_t(read.from.plane)];
        of_input = larger(of_input, around(computed, read.margin, pass.multiple_of_px));
      }
    }
    return needed;
  }

  StripNeeds of_strips(const Margins& after) {
    const std::vector<Margin> at_end = by_plane(after);
    StripNeeds needs;
    std::vector<Written> wholes;
    for (std::size_t k = 0; k < passes_.size(); ++k) {
      std::vector<Written> gathered;
      for (const Pass::Read& read : passes_[k].reads)
        if (read.margin.rows >= kAnywhere && !contains(wholes, read.from) && exists(read.from))
          gathered.push_back(read.from);
      if (!gathered.empty()) {
        std::vector<Margin> needed(planes_.size(), kNotNeeded);
        for (const Written& each : gathered) needed[std::size_t(each.plane)] = {};
        needs.sweeps.push_back(by_name(before(k, std::move(needed), wholes)));
        if (!passes_[k].is_meter) wholes.insert(wholes.end(), gathered.begin(), gathered.end());
      }
      for (const int plane : passes_[k].writes)
        if (passes_[k].on_host) wholes.push_back({plane, int(k)});
    }
    needs.sweeps.push_back(by_name(before(passes_.size(), at_end, wholes)));
    for (const Written& each : wholes) {
      const int reduced = planes_[std::size_t(each.plane)].second;
      const double area = 1.0 / double(reduced * reduced);
      needs.whole_planes += area;
      if (reduced == 1) needs.whole_names.push_back(planes_[std::size_t(each.plane)].first);
      if (each.pass >= 0) needs.not_stored += area;
    }
    return needs;
  }

  Margins before_all(const Margins& after) { return by_name(before(passes_.size(), by_plane(after), {})); }

 private:
  /// Returns whether a plane is not neutral.
  bool exists(const Written& written) const {
    if (written.pass < 0) return !given_ || contains(*given_, planes_[std::size_t(written.plane)].first);
    const Pass& pass = passes_[std::size_t(written.pass)];
    return !pass.is_copy || exists(pass.reads[0].from);
  }

  /// Returns the index of a plane at a resolution.
  int plane(const std::string& name, int reduced) {
    const auto found = std::find(planes_.begin(), planes_.end(), std::pair(name, reduced));
    if (found != planes_.end()) return int(found - planes_.begin());
    planes_.emplace_back(name, reduced);
    writers_.push_back(-1);
    return int(planes_.size()) - 1;
  }

  static constexpr int kComputed = 0;  // stands for all that is computed

  void read(int plane, const Margin& margin, Pass& pass) const {
    pass.reads.push_back({{plane, writers_[std::size_t(plane)]}, margin});
  }

  void add(Pass pass) {
    for (const int plane : pass.writes) writers_[std::size_t(plane)] = int(passes_.size());
    passes_.push_back(std::move(pass));
  }

  void add(const Program& program, const Operation& operation) {
    const std::vector<std::string> reads = program.names_of(operation.reads);
    const std::vector<std::string> writes = program.names_of(operation.writes);
    switch (operation.kind) {
      case OperationKind::kRun:
        return add_effect(operation, params_of_operation(run_, operation, 0.0f));
      case OperationKind::kExternal:  // reads the scene
        return;
      case OperationKind::kReduce:
      case OperationKind::kPlace:
        for (std::size_t k = 0; k < reads.size(); ++k) {
          const bool places = operation.kind == OperationKind::kPlace;
          Pass pass{.is_copy = true, .multiple_of_px = operation.reduced};
          read(plane(reads[k], places ? operation.reduced : 1), {}, pass);
          pass.writes.push_back(plane(writes[k], places ? 1 : operation.reduced));
          add(std::move(pass));
        }
        return;
      case OperationKind::kMeter: {
        Pass pass{.is_meter = true};
        if (!run_.stops && operation.exposure != Exposure::kLights)
          for (const std::string& name : reads) read(plane(name, 1), {kAnywhere, kAnywhere}, pass);
        return add(std::move(pass));
      }
    }
  }

  void add_effect(const Operation& operation, const ParameterBytes& params) {
    const Effect& effect = *operation.effect;
    const int reduced = operation.reduced;
    const PictureInfo info = layer_info(reduced > 1 ? reduced_info(info_, reduced) : info_, operation.layer);
    std::vector<std::byte> constants(effect.constants_size);
    effect.constants(params, info, constants.data());
    for (const auto& [dispatch, round] : dispatches_in_order(effect, params, info, operation.pixels)) {
      Pass pass{.on_host = dispatch->host != nullptr};
      const auto reach_of = [&](int (*reach)(const void*, int)) {
        return reach ? std::min(reach(constants.data(), round) * reduced, kAnywhere) : kAnywhere;
      };
      const Margin margin{reach_of(dispatch->reach), reach_of(dispatch->columns              ? dispatch->columns
                                                              : dispatch->reach == own_pixel ? own_pixel
                                                                                             : nullptr)};
      for (const std::string_view input : dispatch->inputs)
        if (layer_of_plane(input) <= int(info.more_layers.size()))
          read(plane(layer_plane(operation.layer, input), reduced),
               contains(dispatch->unbounded_inputs, input) ? Margin{kAnywhere, kAnywhere} : margin, pass);
      for (const std::string_view output : dispatch->outputs)
        if (layer_of_plane(output) <= int(info.more_layers.size()))
          pass.writes.push_back(plane(layer_plane(operation.layer, output), reduced));
      add(std::move(pass));
    }
  }

  std::vector<Margin> by_plane(const Margins& margins) {
    for (const auto& [name, margin] : margins) plane(name, 1);
    std::vector<Margin> all(planes_.size(), kNotNeeded);
    for (const auto& [name, margin] : margins) all[std::size_t(plane(name, 1))] = margin;
    return all;
  }

  Margins by_name(const std::vector<Margin>& all) const {
    Margins margins;
    for (std::size_t k = 0; k < all.size(); ++k)
      if (all[k].rows >= 0 && planes_[k].second == 1) margins[planes_[k].first] = all[k];
    return margins;
  }

  const LookRun& run_;
  const PictureInfo& info_;
  const std::optional<std::span<const std::string>> given_;
  std::vector<std::pair<std::string, int>> planes_;  // name, downsampling factor
  std::vector<int> writers_;                         // of each plane so far
  std::vector<Pass> passes_;
};

}  // namespace

Margins margins_before(const LookRun& run, const PictureInfo& info, std::span<const EffectStep> before,
                       const Margins& after) {
  return Passes(run, info, before, {}).before_all(after);
}

StripNeeds needs_of_strips(const LookRun& run, const PictureInfo& info, std::span<const EffectStep> before,
                           std::span<const std::string> given, const Margins& after) {
  return Passes(run, info, before, given).of_strips(after);
}

namespace {

/// The planes of a frame, and of the one of reduced resolution that is made from it.
class Frames {
 public:
  explicit Frames(std::span<const std::string> given) {
    for (const std::string& name : given) stored_.emplace(name, 1);
    count();
  }

  void write(const std::string& name, int reduced) {
    stored_.emplace(name, reduced);
    count();
  }
  /// Neutral planes of one value share one plane.
  void read(const std::string& name, int reduced) {
    if (!has(name, reduced) && neutral_value(name)) neutral_.emplace(name, reduced);
    count();
  }
  bool has(const std::string& name, int reduced) const { return stored_.contains({name, reduced}); }
  /// Releases the planes for which `is_unread(name, reduced)`.
  template <class IsUnread>
  void release(const IsUnread& is_unread) {
    for (auto* planes : {&stored_, &neutral_})
      std::erase_if(*planes, [&](const auto& each) { return is_unread(each.first, each.second); });
    count();
  }
  LivePlanes live() const { return {max_, now_}; }

 private:
  void count() {
    std::set<std::pair<float, int>> constants;
    for (const auto& [name, reduced] : neutral_) constants.emplace(*neutral_value(name), reduced);
    now_ = 0.0;
    for (const auto& [name, reduced] : stored_) now_ += 1.0 / double(reduced * reduced);
    for (const auto& [value, reduced] : constants) now_ += 1.0 / double(reduced * reduced);
    max_ = std::max(max_, now_);
  }

  std::set<std::pair<std::string, int>> stored_, neutral_;  // name, downsampling factor
  double now_ = 0.0, max_ = 0.0;
};

/// Runs the dispatches of an operation. `last_used`: planes that nothing uses after it.
void run_dispatches(const LookRun& run, const Operation& operation, const PictureInfo& info,
                    const std::vector<std::string>& last_used, Frames& frames) {
  const auto dispatches = dispatches_in_order(*operation.effect, params_of_operation(run, operation, 0.0f),
                                              layer_info(info, operation.layer), operation.pixels);
  const auto exists = [&](std::string_view name) { return layer_of_plane(name) <= int(info.more_layers.size()); };
  for (std::size_t k = 0; k < dispatches.size(); ++k) {
    const Dispatch& dispatch = *dispatches[k].first;
    for (const std::string_view name : dispatch.inputs)
      frames.read(layer_plane(operation.layer, name), operation.reduced);
    for (const std::string_view name : dispatch.outputs)
      if (exists(name)) frames.write(layer_plane(operation.layer, name), operation.reduced);
    if (operation.reduced > 1 || operation.layer > 0) continue;
    frames.release([&](const std::string& name, int reduced) {
      return reduced == 1 && uses(dispatch, name) && contains(last_used, name) &&
             std::none_of(dispatches.begin() + long(k) + 1, dispatches.end(),
                          [&](const auto& later) { return uses(*later.first, name); });
    });
  }
}

}  // namespace

LivePlanes live_planes(const LookRun& run, const PictureInfo& info, std::span<const std::string> given) {
  const Program program = compile(run, 1 + int(info.more_layers.size()), &info);
  Frames frames(given);
  const std::vector<std::string> kept = run.kept.value_or(std::vector<std::string>());
  for (std::size_t k = 0; k < program.operations.size(); ++k) {
    const Operation& operation = program.operations[k];
    const std::vector<std::string> last_used = run.kept ? program.last_used(k) : std::vector<std::string>();
    if (operation.kind == OperationKind::kRun) {
      run_dispatches(run, operation, info, last_used, frames);
    } else if (operation.kind != OperationKind::kMeter) {
      const std::vector<std::string> writes = program.names_of(operation.writes);
      for (const std::string& name : writes)
        if (operation.kind != OperationKind::kReduce || frames.has(name, 1))
          frames.write(name, operation.kind == OperationKind::kReduce ? operation.reduced : 1);
    }
    const auto needed = program.needed_after(k, kept);
    frames.release([&](const std::string& name, int reduced) {
      return reduced > 1 ? operation.kind == OperationKind::kPlace
                         : run.kept && !needed.contains(name_on_first_layer(name));
    });
  }
  return frames.live();
}

}  // namespace umbrage
