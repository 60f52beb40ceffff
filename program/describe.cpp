// Programs in words.
#include <fmt/format.h>

#include "core/lists.h"
#include "program/program.h"

namespace umbrage {
namespace {

/// Returns the passes of planes, each once: "depth, normal, layer1.depth".
std::string passes_of(const Program& program, std::span<const int> planes) {
  std::vector<std::string> passes;
  for (const std::string& plane : program.names_of(planes))
    if (const std::string name = pass_of(plane); !contains(passes, name)) passes.push_back(name);
  return fmt::format("{}", fmt::join(passes, ", "));
}

std::string name_of(const Operation& operation) {
  switch (operation.kind) {
    case OperationKind::kReduce:
      return "reduce";
    case OperationKind::kPlace:
      return "place";
    case OperationKind::kMeter:
      return "meter";
    case OperationKind::kRun:
    case OperationKind::kExternal:
      break;
  }
  return std::string(operation.effect->name);
}

}  // namespace

std::vector<OperationText> described(const Program& program) {
  std::vector<OperationText> texts;
  for (std::size_t k = 0; k < program.operations.size(); ++k) {
    const Operation& operation = program.operations[k];
    OperationText& text = texts.emplace_back(OperationText{name_of(operation), ""});
    std::vector<std::string> parts;
    if (operation.reduced > 1) parts.push_back(fmt::format("at 1/{}", operation.reduced));
    if (operation.layer > 0) parts.push_back(fmt::format("on layer {}", operation.layer));
    if (operation.pixels == PixelSet::kMissing) parts.emplace_back("for missing pixels");
    if (!operation.reads.empty()) parts.push_back("reads " + passes_of(program, operation.reads));
    if (!operation.writes.empty()) parts.push_back("writes " + passes_of(program, operation.writes));
    std::vector<int> ended;
    for (std::size_t id = 0; id < program.planes.size(); ++id)
      if (!program.planes[id].kept && program.planes[id].last_user == int(k)) ended.push_back(int(id));
    if (!ended.empty()) parts.push_back("frees " + passes_of(program, ended));
    text.summary = fmt::format("{}", fmt::join(parts, "; "));
  }
  return texts;
}

}  // namespace umbrage
