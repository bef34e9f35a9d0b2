#pragma once
// What is wrong with a scene, and where.

#include <string>
#include <vector>

namespace couplet::scene {

/// Where a field was given: at a line and column of the scene, or by a setting of the command line.
struct Place {
  int line = 1;         // 1, 2, ...; 0: given by a setting
  int column = 1;       // in bytes, 1, 2, ...
  std::string setting;  // "PATH=VALUE" of --set; empty: in the scene itself
};

/// A complaint about one field: `scene.txtpb:14:9: solid.body[0].material.density: -1 is not above 0; ...`
struct Complaint {
  std::string file;  // of a setting: `--set PATH=VALUE`
  int line = 0;      // 1, 2, ...; 0: not in the file but given by --set
  int column = 0;
  std::string field;     // path in the scene; empty: the scene as a whole, or the field that the setting names
  std::string sentence;  // what is wrong; what to do instead

  std::string text() const;
};

/// The complaints about one scene, in the order in which they are found.
class ComplaintList {
 public:
  explicit ComplaintList(std::string file) : file_(std::move(file)) {}
  void add(const Place& place, const std::string& field, const std::string& sentence);
  std::size_t size() const { return complaints_.size(); }
  /// All of them by line and column, those about settings last; none twice.
  std::vector<Complaint> in_order() const;

 private:
  std::string file_;
  std::vector<Complaint> complaints_;
};

}  // namespace couplet::scene
