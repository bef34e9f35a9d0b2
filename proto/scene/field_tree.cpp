#include "proto/scene/field_tree.hpp"

#include <algorithm>
#include <cassert>

#include "proto/scene/field_path.hpp"

namespace couplet::scene {

std::string FieldTree::path_to(const std::string& name, int index) const {
  std::string inner = path.empty() ? name : path + "." + name;
  if (index >= 0) inner.append("[").append(std::to_string(index)).append("]");
  return inner;
}

std::string FieldTree::path_of_next(const std::string& name, bool is_list) const {
  const auto found = entries_.find(name);
  const std::size_t n_entries = found == entries_.end() ? 0 : found->second.size();
  return path_to(name, is_list ? static_cast<int>(n_entries) : -1);
}

FieldTree& FieldTree::add(const std::string& name, bool is_list, const Place& at) {
  FieldTree child;
  child.path = path_of_next(name, is_list);
  child.place = at;
  std::vector<FieldTree>& entries = entries_[name];
  return entries.emplace_back(std::move(child));
}

void FieldTree::clear(const std::string& name) {
  entries_.erase(name);
  unreadable_.erase(name);
}

void FieldTree::keep_first(const std::string& name, int n) {
  unreadable_.erase(name);
  const auto found = entries_.find(name);
  if (found == entries_.end()) return;
  const auto kept = std::min(found->second.size(), static_cast<std::size_t>(n));
  found->second.resize(kept);
}

void FieldTree::take(const std::string& name, std::optional<int> index, const FieldTree& other) {
  unreadable_.erase(name);
  if (!index) {
    const auto found = other.entries_.find(name);
    entries_[name] = found == other.entries_.end() ? std::vector<FieldTree>{} : found->second;
    return;
  }
  const FieldTree* const given = other.entry(name, *index);
  std::vector<FieldTree>& entries = entries_[name];
  const auto i = static_cast<std::size_t>(*index);
  assert(given != nullptr && i <= entries.size());
  i < entries.size() ? void(entries[i] = *given) : entries.push_back(*given);
}

void FieldTree::remember_unreadable(const std::string& name, const Place& at) {
  unreadable_.emplace(name, at);
}

const FieldTree* FieldTree::entry(const std::string& name, int index) const {
  const auto found = entries_.find(name);
  if (found == entries_.end() || index < 0 || index >= static_cast<int>(found->second.size())) return nullptr;
  return &found->second[static_cast<std::size_t>(index)];
}

FieldTree* FieldTree::entry(const std::string& name, int index) {
  return const_cast<FieldTree*>(static_cast<const FieldTree*>(this)->entry(name, index));
}

bool FieldTree::is_given(const std::string& name) const {
  return first_place(name) != nullptr;
}

const Place* FieldTree::first_place(const std::string& name) const {
  if (const FieldTree* const first = entry(name)) return &first->place;
  const auto found = unreadable_.find(name);
  return found == unreadable_.end() ? nullptr : &found->second;
}

const FieldTree& FieldTree::deepest(const std::string& wanted_path) const {
  const FieldTree* here = this;
  for (const PathStep& step : split_path(wanted_path)) {
    const FieldTree* const inner = here->entry(step.name, step.index.value_or(0));
    if (inner == nullptr) break;
    here = inner;
  }
  return *here;
}

}  // namespace couplet::scene
