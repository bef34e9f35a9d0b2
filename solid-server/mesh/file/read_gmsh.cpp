#include "solid-server/mesh/file/read_gmsh.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <utility>

#include "solid-server/mesh/file/labelled_mesh.hpp"
#include "solid-server/mesh/file/mesh_text.hpp"

namespace couplet::solid {

namespace {

/// What Gmsh calls its elements by number.
struct GmshElement {
  int type, dimension, n_nodes, n_corners;
  const char* name;
  const char* remedy;  // why it is refused; empty: it is read
};

constexpr const char* second_order = "set Mesh.ElementOrder=2 and Mesh.SecondOrderIncomplete=1, and save again";
constexpr const char* serendipity = "set Mesh.SecondOrderIncomplete=1 and save again";
constexpr const char* other_shape = "mesh the volumes with hexahedra or tetrahedra only";

constexpr std::array<GmshElement, 19> gmsh_elements = {{
    {1, 1, 2, 2, "2-node line", ""},
    {2, 2, 3, 3, "3-node triangle", second_order},
    {3, 2, 4, 4, "4-node quadrilateral", ""},
    {4, 3, 4, 4, "4-node tetrahedron", second_order},
    {5, 3, 8, 8, "8-node hexahedron", ""},
    {6, 3, 6, 6, "6-node prism", other_shape},
    {7, 3, 5, 5, "5-node pyramid", other_shape},
    {8, 1, 3, 2, "3-node line", ""},
    {9, 2, 6, 3, "6-node triangle", ""},
    {10, 2, 9, 4, "9-node quadrilateral", serendipity},
    {11, 3, 10, 4, "10-node tetrahedron", ""},
    {12, 3, 27, 8, "27-node hexahedron", serendipity},
    {13, 3, 18, 6, "18-node prism", other_shape},
    {14, 3, 14, 5, "14-node pyramid", other_shape},
    {15, 0, 1, 1, "point", ""},
    {16, 2, 8, 4, "8-node quadrilateral", ""},
    {17, 3, 20, 8, "20-node hexahedron", ""},
    {18, 3, 15, 6, "15-node prism", other_shape},
    {19, 3, 13, 5, "13-node pyramid", other_shape},
}};

/// Our node a is Gmsh's node hexahedron20_order[a]. Corners agree. Gmsh's midside nodes 8 to 19 lie between corners
/// 0-1, 0-3, 0-4, 1-2, 1-5, 2-3, 2-6, 3-7, 4-5, 4-7, 5-6, 6-7; ours between 0-1, 1-2, 2-3, 3-0, 4-5, 5-6, 6-7, 7-4,
/// 0-4, 1-5, 2-6, 3-7.
constexpr std::array<std::size_t, 20> hexahedron20_order = {0,  1, 2,  3,  4,  5,  6,  7,  8,  11,
                                                            13, 9, 16, 18, 19, 17, 10, 12, 14, 15};

/// Our node a is Gmsh's node tetrahedron10_order[a]. Gmsh's last two midside nodes lie between corners 2-3 and 1-3,
/// ours between 1-3 and 2-3.
constexpr std::array<std::size_t, 10> tetrahedron10_order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

/// A physical group: dimension and number.
using Group = std::pair<int, std::int64_t>;

class GmshReader {
 public:
  GmshReader(std::string_view text, const std::string& file, double length_unit)
      : text_(text, file), mesh_(file, length_unit) {}

  SolidMesh read();

 private:
  void read_format();
  void read_section(std::string_view section);
  void skip_section(std::string_view section);
  void expect_section_end(std::string_view section);
  void read_physical_names();
  void read_entities();
  void read_nodes_4();
  void read_nodes_2();
  void read_elements_4();
  void read_elements_2();
  void read_element_data();
  const GmshElement& element_of_type(std::int64_t type) const;
  void refuse_unless_read(const GmshElement& element, bool is_in_group) const;
  void add_element(const GmshElement& element, std::int64_t label, LineValues& values,
                   const std::vector<Group>& groups);
  void add_solid(const GmshElement& element, std::int64_t label, const std::vector<std::int64_t>& nodes,
                 const std::vector<Group>& groups);
  std::string name_of(const Group& group) const;
  /// Values of one line that must be nothing else.
  std::int64_t count_line(const char* what);
  Eigen::Vector3d vector(LineValues& values, const char* what) const;

  MeshText text_;
  LabelledMesh mesh_;
  bool is_version_4_ = false;
  bool has_entities_ = false;
  std::map<Group, std::string> name_;
  std::map<Group, std::vector<Group>> groups_of_entity_;  // version 4: by dimension and number of the entity
};

std::int64_t GmshReader::count_line(const char* what) {
  text_.next_or_refuse(what);
  LineValues values(text_);
  const std::int64_t count = values.integer(what);
  values.expect_end(what);
  if (count < 0) text_.refuse(std::string(what) + " is " + std::to_string(count));
  return count;
}

Eigen::Vector3d GmshReader::vector(LineValues& values, const char* what) const {
  Eigen::Vector3d vector;
  for (double& component : vector) component = values.number(what);
  return vector;
}

std::string GmshReader::name_of(const Group& group) const {
  const auto found = name_.find(group);
  return found == name_.end() ? std::to_string(group.second) : found->second;
}

void GmshReader::read_format() {
  while (true) {
    if (!text_.next()) text_.refuse("the file is empty", "give a mesh saved by Gmsh");
    if (text_.line().empty()) continue;
    if (text_.line() != "$Comments") break;
    skip_section("Comments");
  }
  if (text_.line() != "$MeshFormat")
    text_.refuse("this is not a Gmsh mesh: it does not begin with $MeshFormat", "save the mesh as .msh, version 4.1");
  text_.next_or_refuse("the version of the format");
  LineValues values(text_);
  const std::string version(values.word("the version of the format"));
  if (version != "4.1" && version != "2.2")
    text_.refuse("version " + version.substr(0, 20) + " of the format is not read",
                 "set Mesh.MshFileVersion=4.1 and save again");
  if (const std::int64_t binary = values.integer("text or binary"); binary != 0)
    text_.refuse("the file is binary", "set Mesh.Binary=0 and save again");
  is_version_4_ = version == "4.1";
  expect_section_end("MeshFormat");
}

void GmshReader::expect_section_end(std::string_view section) {
  const std::string end = "$End" + std::string(section);
  do text_.next_or_refuse(end);
  while (text_.line().empty());
  if (text_.line() != end) text_.refuse("here " + end + " should stand", "the numbers of lines before it are wrong");
}

void GmshReader::skip_section(std::string_view section) {
  const std::string end = "$End" + std::string(section);
  do text_.next_or_refuse(end);
  while (text_.line() != end);
}

void GmshReader::read_physical_names() {
  for (std::int64_t n = count_line("the number of physical names"); n > 0; --n) {
    text_.next_or_refuse("all physical names");
    LineValues values(text_);
    const auto dimension = values.integer("the dimension of a physical group");
    const auto number = values.integer("the number of a physical group");
    const std::size_t first = text_.line().find('"'), last = text_.line().rfind('"');
    if (first == last) text_.refuse("the name of the physical group is not between quotation marks");
    name_[{static_cast<int>(dimension), number}] = text_.line().substr(first + 1, last - first - 1);
  }
}

void GmshReader::read_entities() {
  has_entities_ = true;
  text_.next_or_refuse("the numbers of entities");
  LineValues counts(text_);
  std::array<std::int64_t, 4> n_entities{};
  for (std::int64_t& n : n_entities) n = counts.integer("the number of entities");
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::int64_t n = n_entities[static_cast<std::size_t>(dimension)]; n > 0; --n) {
      text_.next_or_refuse("all entities");
      LineValues values(text_);
      const std::int64_t tag = values.integer("the number of an entity");
      vector(values, "the place of an entity");
      if (dimension > 0) vector(values, "the extent of an entity");
      for (std::int64_t g = values.integer("the number of physical groups"); g > 0; --g)
        groups_of_entity_[{dimension, tag}].push_back({dimension, std::abs(values.integer("a physical group"))});
    }
}

void GmshReader::read_nodes_4() {
  text_.next_or_refuse("the number of blocks of nodes");
  LineValues head(text_);
  std::vector<std::int64_t> labels;
  for (std::int64_t block = head.integer("the number of blocks of nodes"); block > 0; --block) {
    text_.next_or_refuse("all blocks of nodes");
    LineValues values(text_);
    values.integer("a dimension"), values.integer("the number of an entity"), values.integer("parametric or not");
    labels.clear();
    for (std::int64_t n = values.integer("the number of nodes"); n > 0; --n) {
      text_.next_or_refuse("all nodes");
      labels.push_back(LineValues(text_).integer("the number of a node"));
    }
    for (const std::int64_t label : labels) {
      text_.next_or_refuse("the places of all nodes");
      LineValues place(text_);
      mesh_.add_node(label, vector(place, "the place of a node"), text_.line_number());
    }
  }
}

void GmshReader::read_nodes_2() {
  for (std::int64_t n = count_line("the number of nodes"); n > 0; --n) {
    text_.next_or_refuse("all nodes");
    LineValues values(text_);
    const std::int64_t label = values.integer("the number of a node");
    mesh_.add_node(label, vector(values, "the place of a node"), text_.line_number());
  }
}

const GmshElement& GmshReader::element_of_type(std::int64_t type) const {
  const auto found =
      std::find_if(gmsh_elements.begin(), gmsh_elements.end(), [&](const auto& e) { return e.type == type; });
  if (found == gmsh_elements.end())
    text_.refuse("elements of type " + std::to_string(type) + " are not read", second_order);
  return *found;
}

void GmshReader::refuse_unless_read(const GmshElement& element, bool is_in_group) const {
  if (element.remedy[0] != '\0' && (element.dimension == 3 || is_in_group))
    text_.refuse(
        std::string("elements of type ") + std::to_string(element.type) + " (" + element.name + ") are not read",
        element.remedy);
}

void GmshReader::add_solid(const GmshElement& element, std::int64_t label, const std::vector<std::int64_t>& nodes,
                           const std::vector<Group>& groups) {
  if (groups.size() > 1)
    text_.refuse("element " + std::to_string(label) + " belongs to the physical volumes \"" + name_of(groups[0]) +
                     "\" and \"" + name_of(groups[1]) + "\"",
                 "put every volume into one physical volume");
  const std::string region = groups.empty() ? "" : name_of(groups.front());
  std::vector<std::int64_t> ordered = nodes;
  if (element.type == 17)
    for (std::size_t a = 0; a < nodes.size(); ++a) ordered[a] = nodes[hexahedron20_order[a]];
  if (element.type == 11)
    for (std::size_t a = 0; a < nodes.size(); ++a) ordered[a] = nodes[tetrahedron10_order[a]];
  const ElementShape shape = element.type == 17  ? ElementShape::hexahedron20
                             : element.type == 5 ? ElementShape::hexahedron8
                                                 : ElementShape::tetrahedron10;
  mesh_.add_element(label, shape, region, ordered, text_.line_number());
}

void GmshReader::add_element(const GmshElement& element, std::int64_t label, LineValues& values,
                             const std::vector<Group>& groups) {
  if (element.dimension < 3 && groups.empty()) return;
  std::vector<std::int64_t> nodes(static_cast<std::size_t>(element.n_nodes));
  for (std::int64_t& node : nodes) node = values.integer("a node of the element");
  values.expect_end("the nodes of the element");
  if (element.dimension == 3) add_solid(element, label, nodes, groups);
  for (const Group& group : groups) {
    if (element.dimension == 2)
      mesh_.add_face(name_of(group), std::span(nodes).first(static_cast<std::size_t>(element.n_corners)),
                     text_.line_number());
    if (element.dimension < 2)
      for (const std::int64_t node : nodes) mesh_.add_to_node_set(name_of(group), node, text_.line_number());
  }
}

void GmshReader::read_elements_4() {
  if (!has_entities_ && !name_.empty())
    text_.refuse("the file has physical names but no $Entities before its elements", "save the mesh with Gmsh again");
  text_.next_or_refuse("the number of blocks of elements");
  LineValues head(text_);
  for (std::int64_t block = head.integer("the number of blocks of elements"); block > 0; --block) {
    text_.next_or_refuse("all blocks of elements");
    LineValues values(text_);
    const auto dimension = static_cast<int>(values.integer("a dimension"));
    const std::int64_t entity = values.integer("the number of an entity");
    const GmshElement& element = element_of_type(values.integer("the type of the elements"));
    const auto found = groups_of_entity_.find({dimension, entity});
    const std::vector<Group> groups = found == groups_of_entity_.end() ? std::vector<Group>{} : found->second;
    refuse_unless_read(element, !groups.empty());
    for (std::int64_t n = values.integer("the number of elements"); n > 0; --n) {
      text_.next_or_refuse("all elements");
      LineValues line(text_);
      const std::int64_t label = line.integer("the number of an element");
      add_element(element, label, line, groups);
    }
  }
}

void GmshReader::read_elements_2() {
  for (std::int64_t n = count_line("the number of elements"); n > 0; --n) {
    text_.next_or_refuse("all elements");
    LineValues values(text_);
    const std::int64_t label = values.integer("the number of an element");
    const GmshElement& element = element_of_type(values.integer("the type of the element"));
    std::vector<Group> groups;
    const std::int64_t n_tags = values.integer("the number of tags");
    for (std::int64_t tag = 0; tag < n_tags; ++tag) {
      const std::int64_t value = std::abs(values.integer("a tag of the element"));
      if (tag == 0 && value != 0) groups.push_back({element.dimension, value});
    }
    refuse_unless_read(element, !groups.empty());
    add_element(element, label, values, groups);
  }
}

void GmshReader::read_element_data() {
  std::string name;
  for (std::int64_t n = count_line("the number of names"), first = n; n > 0; --n) {
    text_.next_or_refuse("the name of the data");
    if (n == first) name = text_.line();
  }
  name.erase(std::remove(name.begin(), name.end(), '"'), name.end());
  if (name != "fibre" && name != "cross_fibre") return skip_section("ElementData");
  for (std::int64_t n = count_line("the number of real tags"); n > 0; --n) text_.next_or_refuse("all real tags");
  std::array<std::int64_t, 3> tag = {0, 0, 0};  // step, numbers an element, elements
  for (std::int64_t n = count_line("the number of whole tags"), place = 0; place < n; ++place) {
    const std::int64_t value = count_line("a whole tag");
    if (place < 3) tag[static_cast<std::size_t>(place)] = value;
  }
  if (tag[1] != 3)
    text_.refuse("the data \"" + name + "\" have " + std::to_string(tag[1]) + " numbers an element",
                 "give directions: 3 numbers");
  for (std::int64_t n = tag[2]; n > 0; --n) {
    text_.next_or_refuse("the data of all elements");
    LineValues values(text_);
    const std::int64_t label = values.integer("the number of an element");
    const Eigen::Vector3d direction = vector(values, "a direction");
    if (name == "fibre")
      mesh_.set_fibre(label, direction, text_.line_number());
    else
      mesh_.set_cross_fibre(label, direction, text_.line_number());
  }
  expect_section_end("ElementData");
}

void GmshReader::read_section(std::string_view section) {
  if (section == "PhysicalNames")
    read_physical_names();
  else if (section == "Entities" && is_version_4_)
    read_entities();
  else if (section == "Nodes")
    is_version_4_ ? read_nodes_4() : read_nodes_2();
  else if (section == "Elements")
    is_version_4_ ? read_elements_4() : read_elements_2();
  else if (section == "ElementData")
    return read_element_data();
  else if (section == "PartitionedEntities")
    text_.refuse("the mesh is partitioned", "save it without partitions");
  else
    return skip_section(section);
  expect_section_end(section);
}

SolidMesh GmshReader::read() {
  read_format();
  while (text_.next()) {
    if (text_.line().empty()) continue;
    if (text_.line().front() != '$') text_.refuse("here a section should begin, such as $Nodes");
    read_section(std::string_view(text_.line()).substr(1));
  }
  return mesh_.finish();
}

}  // namespace

SolidMesh read_gmsh(std::string_view text, const std::string& file, double length_unit) {
  return GmshReader(text, file, length_unit).read();
}

}  // namespace couplet::solid
