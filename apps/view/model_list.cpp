#include "apps/view/model_list.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace umbrage::view {
namespace {

constexpr std::size_t kMaxLoaded = 3;  // models in memory; others are loaded again

}  // namespace

int ModelList::add(ModelSource source) {
  const std::lock_guard lock(mutex_);
  entries_.push_back(std::make_unique<Entry>());
  entries_.back()->source = std::move(source);
  return int(entries_.size()) - 1;
}

nlohmann::json ModelList::as_json() const {
  const std::lock_guard lock(mutex_);
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t id = 0; id < entries_.size(); ++id) {
    const ModelSource& source = entries_[id]->source;
    list.push_back(
        {{"id", id}, {"name", source.name}, {"file", source.file}, {"kind", source.is_gbuffer ? "gbuffer" : "model"}});
  }
  return list;
}

bool ModelList::has(int id) const {
  const std::lock_guard lock(mutex_);
  return id >= 0 && std::size_t(id) < entries_.size();
}

ModelSource ModelList::source(int id) const {
  const std::lock_guard lock(mutex_);
  return entries_[std::size_t(id)]->source;
}

ModelList::Stamp ModelList::stamp_of(const std::string& file) {
  std::error_code ignored;
  Stamp stamp;
  stamp.time = std::filesystem::last_write_time(file, ignored);
  stamp.size = std::filesystem::file_size(file, ignored);
  return stamp;
}

Result<ModelList::Loaded> ModelList::loaded(int id, const Request& request,
                                            const std::function<void(const Error&)>& keep,
                                            const ProgressMonitor& monitor,
                                            const std::function<void(const std::function<void()>&)>& aside) {
  std::unique_lock lock(mutex_);
  Entry& entry = *entries_[std::size_t(id)];
  const bool serves = entry.model && entry.model->is_loaded_for(request);
  if (serves && !entry.has_changed) {
    recent_.remove(id);
    recent_.push_front(id);
    return Loaded{entry.model.get(), entry.version};
  }
  lock.unlock();
  const Stamp stamp = stamp_of(entry.source.file);
  Result<std::unique_ptr<ViewModel>> model = interrupted();
  aside([&] { model = ViewModel::load(entry.source.file, entry.source.is_gbuffer, request, monitor); });
  if (!model && model.error().kind == ErrorKind::kInterrupted) return model.error();
  lock.lock();
  const bool has_changed = std::exchange(entry.has_changed, false);
  entry.stamp = entry.seen = stamp;
  if (!model) {
    if (!serves || !entry.model) return model.error();
    lock.unlock();
    keep(model.error());
    return Loaded{entry.model.get(), entry.version};
  }
  // Pages need not know of a new moment of an animation, or that a model is in memory again.
  if (has_changed || (*model)->facts().summary != entry.summary || (*model)->facts().up != entry.up) ++entry.version;
  entry.summary = (*model)->facts().summary;
  entry.up = (*model)->facts().up;
  entry.model = std::move(*model);
  entry.is_loaded = true;
  recent_.remove(id);
  recent_.push_front(id);
  if (recent_.size() > kMaxLoaded) {
    Entry& oldest = *entries_[std::size_t(recent_.back())];
    oldest.model.reset();
    oldest.is_loaded = oldest.has_changed = false;
    recent_.pop_back();
  }
  return Loaded{entry.model.get(), entry.version};
}

void ModelList::forget_captures() {
  const std::lock_guard lock(mutex_);
  for (const auto& entry : entries_)
    if (entry->model) entry->model->forget_captures();
}

std::vector<int> ModelList::find_changed() {
  const std::lock_guard lock(mutex_);
  std::vector<int> changed;
  for (std::size_t id = 0; id < entries_.size(); ++id) {
    Entry& entry = *entries_[id];
    if (!entry.is_loaded || entry.has_changed) continue;
    const Stamp now = stamp_of(entry.source.file);
    const bool is_stable = now == entry.seen;
    entry.seen = now;
    if (!is_stable || now == entry.stamp) continue;
    entry.has_changed = true;
    changed.push_back(int(id));
  }
  return changed;
}

}  // namespace umbrage::view
