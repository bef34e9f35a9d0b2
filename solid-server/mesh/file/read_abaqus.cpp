#include "solid-server/mesh/file/read_abaqus.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "solid-server/mesh/file/abaqus_lines.hpp"
#include "solid-server/mesh/file/labelled_mesh.hpp"
#include "solid-server/mesh/hex20_topology.hpp"

namespace couplet::solid {

namespace {

struct AbaqusElement {
  const char* type;
  ElementShape shape;
};

constexpr std::array<AbaqusElement, 6> abaqus_elements = {{{"C3D20", ElementShape::hexahedron20},
                                                           {"C3D20R", ElementShape::hexahedron20},
                                                           {"C3D8", ElementShape::hexahedron8},
                                                           {"C3D8R", ElementShape::hexahedron8},
                                                           {"C3D8I", ElementShape::hexahedron8},
                                                           {"C3D10", ElementShape::tetrahedron10}}};

/// Elements of surfaces: their corners name a face of a solid element.
struct AbaqusFace {
  const char* type;
  std::size_t n_nodes, n_corners;
};

constexpr std::array<AbaqusFace, 24> abaqus_faces = {
    {{"S3", 3, 3},   {"S3R", 3, 3},   {"S4", 4, 4},    {"S4R", 4, 4},  {"S6", 6, 3},    {"STRI65", 6, 3},
     {"S8", 8, 4},   {"S8R", 8, 4},   {"CPS3", 3, 3},  {"CPS4", 4, 4}, {"CPS4R", 4, 4}, {"CPS6", 6, 3},
     {"CPS8", 8, 4}, {"CPS8R", 8, 4}, {"CPE3", 3, 3},  {"CPE4", 4, 4}, {"CPE6", 6, 3},  {"CPE8", 8, 4},
     {"M3D3", 3, 3}, {"M3D4", 4, 4},  {"M3D4R", 4, 4}, {"M3D6", 6, 3}, {"M3D8", 8, 4},  {"M3D8R", 8, 4}}};

constexpr std::array<const char*, 6> abaqus_lines = {"T3D2", "T3D3", "B31", "B31R", "B32", "B32R"};

/// Our place of sides S1, S2, ...
constexpr std::array<int, 6> hexahedron_side = {hex20::zeta_min, hex20::zeta_max, hex20::eta_min,
                                                hex20::xi_max,   hex20::eta_max,  hex20::xi_min};
constexpr std::array<int, 6> tetrahedron_side = {0, 1, 2, 3, -1, -1};

/// Keywords that make or move nodes and elements in ways that are not read: to skip them would give another mesh.
const std::map<std::string, std::string> refused_keywords = {
    {"INCLUDE", "put the text of that file here"},
    {"SYSTEM", "write the nodes in the global axes"},
    {"NGEN", "write every node out"},
    {"NFILL", "write every node out"},
    {"NCOPY", "write every node out"},
    {"NMAP", "write every node out"},
    {"ELGEN", "write every element out"},
    {"ELCOPY", "write every element out"},
    {"PARAMETER", "write numbers in place of the parameters"},
};

struct Member {
  std::int64_t label;
  int line;
};

struct NamedSet {
  std::string name;  // as it is first written
  std::vector<Member> member;
  bool may_be_region = false;
};

using Sets = std::map<std::string, NamedSet>;  // by name in capitals

class AbaqusReader {
 public:
  AbaqusReader(std::string_view text, const std::string& file, double length_unit)
      : lines_(text, file), mesh_(file, length_unit) {}

  MeshReading read();

 private:
  struct SurfaceEntry {
    std::string surface, what;  // element or set
    std::string side;
    int line;
  };

  void read_keyword();
  void read_nodes();
  void read_elements();
  void read_solid_elements(const AbaqusElement& kind, NamedSet* set);
  void read_face_elements(const AbaqusFace& kind, NamedSet* set);
  void skip_line_elements();
  std::vector<std::int64_t> nodes_of_element(const char* type, std::size_t n_nodes, std::int64_t& label);
  void read_set(Sets& sets);
  void read_surface();
  void read_instance();
  NamedSet& set_named(Sets& sets, const std::string& name);
  void add_range(NamedSet& set);
  void add_member(Sets& sets, NamedSet& set, std::string_view word);
  void add_members(Sets& sets, NamedSet& set);
  void add_surfaces();
  void add_side(const SurfaceEntry& entry, std::int64_t element);
  void add_faces_of_sets();
  void choose_regions();
  const MeshText& text() const { return lines_.text(); }

  AbaqusLines lines_;
  LabelledMesh mesh_;
  Sets node_set_, element_set_;
  std::vector<SurfaceEntry> surface_entry_;
  std::vector<std::int64_t> element_label_;                            // of solid elements
  std::map<std::int64_t, std::vector<std::int64_t>> corners_of_face_;  // by the label of a surface element
  std::set<std::int64_t> line_label_;                                  // of line elements
  int n_instances_ = 0;
  bool has_regions_ = false;  // an *ELEMENT names a set
  std::vector<std::string> skipped_;
};

/// A member of a set as the assembly of one instance writes it: INSTANCE.LABEL.
std::string_view without_instance(std::string_view word) {
  const std::size_t dot = word.rfind('.');
  return dot == std::string_view::npos ? word : word.substr(dot + 1);
}

/// -1 when the word is no label.
std::int64_t label_in(std::string_view word) {
  if (word.empty() || word.size() > 18 ||
      !std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; }))
    return -1;
  std::int64_t label = 0;
  for (const char c : word) label = 10 * label + (c - '0');
  return label;
}

NamedSet& AbaqusReader::set_named(Sets& sets, const std::string& name) {
  NamedSet& set = sets[in_capitals(name)];
  if (set.name.empty()) set.name = name;
  return set;
}

void AbaqusReader::read_nodes() {
  if (lines_.has("INPUT")) text().refuse("the nodes stand in another file", "put the text of that file here");
  if (lines_.has("SYSTEM")) text().refuse("*NODE with SYSTEM is not read", "write the nodes in the global axes");
  const std::string name = lines_.value_of("NSET");
  NamedSet* const set = name.empty() ? nullptr : &set_named(node_set_, name);
  while (lines_.next_data()) {
    LineValues values(text(), ',');
    const std::int64_t label = values.integer("the number of a node");
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // coordinates that are left out are 0
    for (Eigen::Index k = 0; k < 3 && !values.is_at_end(); ++k) position[k] = values.number("the place of a node");
    mesh_.add_node(label, position, text().line_number());
    if (set != nullptr) set->member.push_back({label, text().line_number()});
  }
}

void AbaqusReader::read_elements() {
  if (lines_.has("INPUT")) text().refuse("the elements stand in another file", "put the text of that file here");
  const std::string type = in_capitals(lines_.required("TYPE"));
  const auto is_of_type = [&](const auto& kind) { return type == kind.type; };
  const auto solid = std::find_if(abaqus_elements.begin(), abaqus_elements.end(), is_of_type);
  const auto face = std::find_if(abaqus_faces.begin(), abaqus_faces.end(), is_of_type);
  const std::string name = lines_.value_of("ELSET");
  NamedSet* const set = name.empty() ? nullptr : &set_named(element_set_, name);
  if (solid != abaqus_elements.end()) return read_solid_elements(*solid, set);
  if (face != abaqus_faces.end()) return read_face_elements(*face, set);
  if (std::find(abaqus_lines.begin(), abaqus_lines.end(), type) != abaqus_lines.end()) return skip_line_elements();
  text().refuse("elements of type " + type.substr(0, 20) + " are not read",
                "use C3D20, C3D20R, C3D8, C3D8R, C3D8I or C3D10");
}

/// The nodes of the element that begins in this line and may go on in the next ones.
std::vector<std::int64_t> AbaqusReader::nodes_of_element(const char* type, std::size_t n_nodes, std::int64_t& label) {
  const int line = text().line_number();
  LineValues values(text(), ',');
  label = values.integer("the number of an element");
  std::vector<std::int64_t> nodes;
  while (true) {
    while (!values.is_at_end()) nodes.push_back(values.integer("a node of the element"));
    if (nodes.size() >= n_nodes || !lines_.next_data()) break;
    values = LineValues(text(), ',');
  }
  if (nodes.size() != n_nodes)
    text().refuse_line(line, "element " + std::to_string(label) + " has " + std::to_string(nodes.size()) + " nodes; " +
                                 type + " has " + std::to_string(n_nodes));
  return nodes;
}

void AbaqusReader::read_solid_elements(const AbaqusElement& kind, NamedSet* set) {
  has_regions_ = has_regions_ || set != nullptr;
  while (lines_.next_data()) {
    const int line = text().line_number();
    std::int64_t label = 0;
    const auto nodes = nodes_of_element(kind.type, static_cast<std::size_t>(topology(kind.shape).n_nodes), label);
    mesh_.add_element(label, kind.shape, set == nullptr ? "" : set->name, nodes, line);
    element_label_.push_back(label);
    if (set != nullptr) set->member.push_back({label, line});
  }
}

void AbaqusReader::read_face_elements(const AbaqusFace& kind, NamedSet* set) {
  while (lines_.next_data()) {
    const int line = text().line_number();
    std::int64_t label = 0;
    auto nodes = nodes_of_element(kind.type, kind.n_nodes, label);
    nodes.resize(kind.n_corners);
    corners_of_face_[label] = std::move(nodes);
    if (set != nullptr) set->member.push_back({label, line});
  }
}

void AbaqusReader::skip_line_elements() {
  while (lines_.next_data()) line_label_.insert(LineValues(text(), ',').integer("the number of an element"));
}

void AbaqusReader::add_range(NamedSet& set) {
  LineValues values(text(), ',');
  const std::int64_t first = values.integer("the first of a range"), last = values.integer("the last of a range");
  const std::int64_t step = values.is_at_end() ? 1 : values.integer("the step of a range");
  if (first < 1 || last < first || step < 1 || (last - first) / step > 100'000'000)
    text().refuse("the range from " + std::to_string(first) + " to " + std::to_string(last) + " by " +
                  std::to_string(step) + " is not a range of labels");
  for (std::int64_t label = first; label <= last; label += step) set.member.push_back({label, text().line_number()});
}

void AbaqusReader::add_member(Sets& sets, NamedSet& set, std::string_view word) {
  if (const std::int64_t label = label_in(word); label >= 0) {
    set.member.push_back({label, text().line_number()});
    return;
  }
  const auto other = sets.find(in_capitals(word));
  if (other == sets.end())
    text().refuse("set \"" + set.name + "\" names \"" + std::string(word.substr(0, 80)) +
                  "\", which is neither a number nor a set that stands above");
  const std::vector<Member> members = other->second.member;  // the set may name itself
  set.member.insert(set.member.end(), members.begin(), members.end());
}

void AbaqusReader::add_members(Sets& sets, NamedSet& set) {
  for (LineValues values(text(), ','); !values.is_at_end();)
    add_member(sets, set, without_instance(values.word("a member of the set")));
}

void AbaqusReader::read_set(Sets& sets) {
  const bool is_element_set = &sets == &element_set_;
  NamedSet& set = set_named(sets, lines_.required(is_element_set ? "ELSET" : "NSET"));
  if (is_element_set && !lines_.has("INTERNAL")) set.may_be_region = true;
  if (!is_element_set && lines_.has("ELSET"))
    text().refuse("*NSET with ELSET is not read", "write the nodes of the set out");
  const bool is_range = lines_.has("GENERATE");
  while (lines_.next_data()) is_range ? add_range(set) : add_members(sets, set);
}

void AbaqusReader::read_surface() {
  const std::string name = lines_.required("NAME"), type = in_capitals(lines_.value_of("TYPE"));
  if (type == "NODE") {
    NamedSet& set = set_named(node_set_, name);
    while (lines_.next_data())  // a node or a set in each line, and perhaps a weight
      add_member(node_set_, set, without_instance(LineValues(text(), ',').word("a node or a set")));
    return;
  }
  if (!type.empty() && type != "ELEMENT")
    text().refuse("*SURFACE of TYPE=" + type.substr(0, 20) + " is not read", "use TYPE=ELEMENT or TYPE=NODE");
  while (lines_.next_data()) {
    LineValues values(text(), ',');
    SurfaceEntry entry{name, std::string(without_instance(values.word("an element or a set"))), "",
                       text().line_number()};
    if (!values.is_at_end()) entry.side = in_capitals(values.word("the side"));
    surface_entry_.push_back(entry);
  }
}

void AbaqusReader::read_instance() {
  if (++n_instances_ > 1)
    text().refuse("the file has several instances of parts", "save a flat input file, without parts and assemblies");
  while (lines_.next_data())
    for (LineValues values(text(), ','); !values.is_at_end();)
      if (values.number("a translation or rotation of the instance") != 0)
        text().refuse("the instance is moved", "save a flat input file, without parts and assemblies");
}

void AbaqusReader::read_keyword() {
  const std::string& keyword = lines_.keyword();
  if (const auto refused = refused_keywords.find(keyword); refused != refused_keywords.end())
    text().refuse("*" + keyword + " is not read", refused->second);
  if (keyword == "NODE") return read_nodes();
  if (keyword == "ELEMENT") return read_elements();
  if (keyword == "NSET") return read_set(node_set_);
  if (keyword == "ELSET") return read_set(element_set_);
  if (keyword == "SURFACE") return read_surface();
  if (keyword == "INSTANCE") return read_instance();
  static const std::set<std::string> said_nothing_by = {"HEADING",  "PREPRINT",     "PART",        "END PART",
                                                        "ASSEMBLY", "END INSTANCE", "END ASSEMBLY"};
  if (said_nothing_by.contains(keyword)) return;
  if (std::find(skipped_.begin(), skipped_.end(), keyword) == skipped_.end()) skipped_.push_back(keyword);
}

void AbaqusReader::add_side(const SurfaceEntry& entry, std::int64_t element) {
  const std::string whose = "surface \"" + entry.surface + "\" ";
  if (!mesh_.has_element(element))
    text().refuse_line(entry.line,
                       whose + "names element " + std::to_string(element) + ", which the file does not have");
  const int n_sides = mesh_.n_faces_of(element);
  const bool is_side =
      entry.side.size() == 2 && entry.side[0] == 'S' && entry.side[1] >= '1' && entry.side[1] < '1' + n_sides;
  if (!is_side)
    text().refuse_line(entry.line,
                       whose + (entry.side.empty() ? "names no side" : "names side " + entry.side.substr(0, 20)) +
                           " of element " + std::to_string(element),
                       "write S1 to S" + std::to_string(n_sides));
  const auto place = static_cast<std::size_t>(entry.side[1] - '1');
  mesh_.add_side(entry.surface, element, n_sides == 4 ? tetrahedron_side[place] : hexahedron_side[place], entry.line);
}

void AbaqusReader::add_surfaces() {
  for (const SurfaceEntry& entry : surface_entry_) {
    if (const std::int64_t label = label_in(entry.what); label >= 0) {
      add_side(entry, label);
      continue;
    }
    const auto set = element_set_.find(in_capitals(entry.what));
    if (set == element_set_.end())
      text().refuse_line(entry.line, "surface \"" + entry.surface + "\" names the set \"" + entry.what.substr(0, 80) +
                                         "\", which the file does not have");
    set->second.may_be_region = false;
    for (const Member& member : set->second.member) add_side(entry, member.label);
  }
}

/// The surface elements of a set are a surface of its name; its solid elements stay, and line elements say nothing.
void AbaqusReader::add_faces_of_sets() {
  for (auto& [key, set] : element_set_) {
    std::vector<Member> solid;
    for (const Member& member : set.member) {
      if (const auto face = corners_of_face_.find(member.label); face != corners_of_face_.end())
        mesh_.add_face(set.name, face->second, member.line);
      else if (!line_label_.contains(member.label))
        solid.push_back(member);
    }
    set.member = std::move(solid);
  }
}

void AbaqusReader::choose_regions() {
  std::vector<const NamedSet*> candidates;
  const NamedSet* of_all = nullptr;
  std::map<std::int64_t, int> n_sets;  // that an element is in
  for (auto& [key, set] : element_set_) {
    std::set<std::int64_t> labels;
    for (const Member& member : set.member) {
      if (!mesh_.has_element(member.label))
        text().refuse_line(member.line, "set \"" + set.name + "\" names element " + std::to_string(member.label) +
                                            ", which the file does not have");
      labels.insert(member.label);
    }
    if (!set.may_be_region || labels.empty()) continue;
    if (labels.size() == element_label_.size()) {
      of_all = &set;
      continue;
    }
    candidates.push_back(&set);
    for (const std::int64_t label : labels) ++n_sets[label];
  }
  const bool is_partition = n_sets.size() == element_label_.size() &&
                            std::all_of(n_sets.begin(), n_sets.end(), [](const auto& n) { return n.second == 1; });
  if (!is_partition || candidates.empty()) candidates.clear();
  if (candidates.empty() && !has_regions_ && of_all != nullptr) candidates.push_back(of_all);
  for (const NamedSet* set : candidates)
    for (const Member& member : set->member) mesh_.set_region(member.label, set->name);
}

MeshReading AbaqusReader::read() {
  if (!lines_.next_keyword())
    text().refuse("this is not an input file of Abaqus or CalculiX: no line begins with a keyword such as *NODE",
                  "save the mesh as .inp");
  do read_keyword();
  while (lines_.next_keyword());
  add_surfaces();
  add_faces_of_sets();
  choose_regions();
  for (const auto& [key, set] : node_set_)
    for (const Member& member : set.member) mesh_.add_to_node_set(set.name, member.label, member.line);
  MeshReading reading;
  reading.mesh = mesh_.finish();
  for (const std::string& keyword : skipped_)
    reading.note += (reading.note.empty() ? "skipped *" : ", *") + keyword.substr(0, 40);
  return reading;
}

}  // namespace

MeshReading read_abaqus(std::string_view text, const std::string& file, double length_unit) {
  return AbaqusReader(text, file, length_unit).read();
}

}  // namespace couplet::solid
