// Runs one effect on a G-buffer made in code, in every form that its kernels have on this CPU.
#pragma once
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/check.h"
#include "core/lists.h"
#include "devices/cpu/cpu_device.h"
#include "effects/effects.h"
#include "kernel/isa.h"
#include "support.h"

namespace umbrage::test {

/// Pairs of a parameter's name and its value as text.
using Settings = std::vector<std::pair<std::string, std::string>>;

// Names of the planes of colours and vectors.
inline constexpr const char* kNormal[] = {"normal.x", "normal.y", "normal.z"};
inline constexpr const char* kAlbedo[] = {"albedo.r", "albedo.g", "albedo.b"};
inline constexpr const char* kDirect[] = {"direct.r", "direct.g", "direct.b"};
inline constexpr const char* kAmbient[] = {"ambient.r", "ambient.g", "ambient.b"};
inline constexpr const char* kIndirect[] = {"indirect.r", "indirect.g", "indirect.b"};
inline constexpr const char* kLit[] = {"lit.r", "lit.g", "lit.b"};

/// Returns both lists of settings; `second` takes precedence.
inline Settings joined(Settings first, const Settings& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// Returns the default parameters of an effect, changed by these settings.
inline ParameterBytes parameters_of(const Effect& effect, const Settings& settings) {
  ParameterBytes bytes = initial_parameters(effect.parameters, effect.params_size);
  for (const auto& [name, value] : settings) {
    const Parameter* row = find_parameter(effect, name);
    if (!row) fail_check("there is no parameter " + name);
    const auto status = set_parameter(effect.name, *row, value, bytes);
    EXPECT_TRUE(status) << (status ? "" : status.error().message);
  }
  return bytes;
}

/// Returns the constants that an effect's kernels read with these settings. `Constants` is the effect's own struct.
template <class Constants>
Constants constants_of(std::string_view name, const PictureInfo& info, const Settings& settings) {
  const Effect& effect = *find_effect(name);
  Constants constants;
  effect.constants(parameters_of(effect, settings), info, &constants);
  return constants;
}

/// Returns the names of the planes that an effect writes, each once. Only the dispatches that it needs count.
inline std::vector<std::string> written_planes(const Effect& effect, const ParameterBytes& params) {
  std::vector<std::string> names;
  for (const Dispatch& dispatch : effect.dispatches) {
    if (!runs(dispatch, params)) continue;
    for (std::string_view name : dispatch.outputs)
      if (!contains(names, name)) names.emplace_back(name);
  }
  return names;
}

/// Runs `effect` on `gbuffer` and returns the planes that it writes; all planes if it writes none.
inline Image run_effect(const Effect& effect, const GBuffer& gbuffer, const Settings& settings,
                        const CpuSettings& cpu) {
  const auto device = make_cpu_device(cpu);
  auto frame = device->upload(gbuffer);
  const ParameterBytes params = parameters_of(effect, settings);
  const auto status = device->run(effect, params, *frame);
  EXPECT_TRUE(status) << (status ? "" : status.error().message);
  const std::vector<std::string> names = written_planes(effect, params);
  return names.empty() ? *device->download_all(*frame) : *device->download(*frame, names);
}

/// Calls `check` with the planes from the scalar kernel, and with those from the lanes on every SIMD target.
inline void on_every_target(std::string_view name, const GBuffer& gbuffer, const Settings& settings,
                            const std::function<void(const Image&)>& check) {
  const Effect& effect = *find_effect(name);
  {
    SCOPED_TRACE("scalar");
    check(run_effect(effect, gbuffer, settings, {.scalar = true}));
  }
  for (const std::string_view target : test::lane_isas()) {
    SCOPED_TRACE(target);
    ASSERT_TRUE(choose_isa(target));
    check(run_effect(effect, gbuffer, settings, {}));
  }
  choose_isa("");
}

}  // namespace umbrage::test
