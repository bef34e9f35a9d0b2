#include "deploy/launcher/shell_words.hpp"

namespace couplet::launcher {

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) {
    if (c == '\'') {
      text.append("'\\''");
    } else {
      text.push_back(c);
    }
  }
  text.push_back('\'');
  return text;
}

}  // namespace couplet::launcher
