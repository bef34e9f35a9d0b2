#include "proto/scene/review.hpp"

#include <algorithm>

namespace couplet::scene {

void Review::complain(const std::string& path, const std::string& sentence) {
  complaints_.add(tree_.deepest(path).place, path, sentence);
}

void Review::complain_missing(const std::string& path, const std::string& sentence) {
  const std::size_t dot = path.rfind('.');
  const FieldTree& block = dot == std::string::npos ? tree_ : tree_.deepest(path.substr(0, dot));
  const std::string name = path.substr(dot == std::string::npos ? 0 : dot + 1);
  if (!braces_match_ || block.unclear || block.is_unreadable(name.substr(0, name.find('[')))) return;
  complaints_.add(block.place, path, sentence);
}

void Review::complain_missing_choice(const std::string& block_path, const std::vector<std::string>& members,
                                     const std::string& sentence) {
  const FieldTree& block = block_path.empty() ? tree_ : tree_.deepest(block_path);
  const auto is_unreadable = [&](const std::string& member) { return block.is_unreadable(member); };
  if (!braces_match_ || block.unclear || std::any_of(members.begin(), members.end(), is_unreadable)) return;
  complaints_.add(block.place, block_path, sentence);
}

}  // namespace couplet::scene
