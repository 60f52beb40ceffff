// The options of the commands of umbrage-lab. Both programs declare all options: for help, manual page, completion and
// the configuration file.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/options.h"

namespace umbrage::cli {

inline constexpr std::array<std::string_view, 4> kLabCommands = {"compare", "tune", "figures", "bench"};

/// Options shared by umbrage compare and umbrage tune.
struct MeasureOptions : CommonOptions {
  int cameras = 2, samples = 256, runs = 3;
};

struct CompareOptions : MeasureOptions {
  std::string techniques, output = "report", baseline, filter, looks, motions;
  bool light = false, budget = false, sequence = false;
  std::vector<std::string> sizes;  // empty: the default
};

struct TuneOptions : MeasureOptions {
  int trials = 100;
  double budget_ms = 0.0;
  bool json = false;
};

struct FiguresOptions : CommonOptions {
  std::string paper = "unsharp", output = "figures", bunny;
  int size = 0;  // side in pixels; 0: that of the paper
  int runs = 5;
};

struct BenchOptions : CommonOptions {
  std::vector<std::string> sizes = {"1024,1024"};
  std::string effect;
  int runs = 9;
  bool json = false;
};

/// What the commands of umbrage-lab do: umbrage starts that program.
struct LabActions {
  Result<void> (*compare)(const CompareOptions&);
  Result<void> (*tune)(const TuneOptions&);
  Result<void> (*figures)(const FiguresOptions&);
  Result<void> (*bench)(const BenchOptions&);
};

/// Adds the commands of umbrage-lab to `app`. Parsing sets `run` to the action of the command that the user names.
void add_lab(CLI::App& app, std::function<Result<void>()>& run, const LabActions& actions);

}  // namespace umbrage::cli
