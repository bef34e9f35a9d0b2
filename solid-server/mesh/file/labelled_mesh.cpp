#include "solid-server/mesh/file/labelled_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/face_search.hpp"

namespace couplet::solid {

bool LabelPlaces::add(std::int64_t label) {
  if (find(label) >= 0) return false;
  if (size_ == 0) first_ = label;
  if (size_ == n_running_ && label == first_ + n_running_) {
    ++n_running_;
  } else {
    scattered_.emplace(label, size_);
  }
  ++size_;
  return true;
}

Index LabelPlaces::find(std::int64_t label) const {
  if (label >= first_ && label - first_ < n_running_) return static_cast<Index>(label - first_);
  const auto found = scattered_.find(label);
  return found == scattered_.end() ? -1 : found->second;
}

void LabelledMesh::refuse(int line, const std::string& sentence, const std::string& advice) const {
  throw report::SceneError(file_ + ":" + std::to_string(line), sentence, advice);
}

void LabelledMesh::add_node(std::int64_t label, const Eigen::Vector3d& position, int line) {
  if (!node_place_.add(label))
    refuse(line, "node " + std::to_string(label) + " is there twice", "give every node its own number");
  node_position_.push_back(position * length_unit_);
}

int LabelledMesh::region_place(const std::string& region) {
  const auto found = std::find(region_.begin(), region_.end(), region);
  if (found != region_.end()) return static_cast<int>(found - region_.begin());
  region_.push_back(region);
  return static_cast<int>(region_.size()) - 1;
}

void LabelledMesh::add_element(std::int64_t label, ElementShape shape, const std::string& region,
                               std::span<const std::int64_t> nodes, int line) {
  if (!element_place_.add(label))
    refuse(line, "element " + std::to_string(label) + " is there twice",
           "give every element its own number; an element belongs to one region only");
  const int place = !element_.empty() && region_[static_cast<std::size_t>(element_.back().region)] == region
                        ? element_.back().region
                        : region_place(region);
  element_.push_back({label, shape, place, element_node_.size(), line});
  element_node_.insert(element_node_.end(), nodes.begin(), nodes.end());
}

void LabelledMesh::add_face(const std::string& surface, std::span<const std::int64_t> corners, int line) {
  face_.push_back({surface, {corners.begin(), corners.end()}, 0, 0, line});
}

void LabelledMesh::add_side(const std::string& surface, std::int64_t element, int side, int line) {
  face_.push_back({surface, {}, element, side, line});
}

void LabelledMesh::add_to_node_set(const std::string& set, std::int64_t node, int line) {
  node_set_[set].push_back({node, line});
}

void LabelledMesh::set_fibre(std::int64_t element, const Eigen::Vector3d& direction, int line) {
  Fibre& fibre = fibre_[element];
  fibre.along = direction;
  fibre.line = line;
}

void LabelledMesh::set_cross_fibre(std::int64_t element, const Eigen::Vector3d& direction, int line) {
  Fibre& fibre = fibre_[element];
  fibre.across = direction;
  if (fibre.line == 0) fibre.line = line;
}

int LabelledMesh::n_faces_of(std::int64_t element) const {
  return topology(element_[static_cast<std::size_t>(element_place_.find(element))].shape).n_faces;
}

void LabelledMesh::set_region(std::int64_t element, const std::string& region) {
  element_[static_cast<std::size_t>(element_place_.find(element))].region = region_place(region);
}

std::span<const std::int64_t> LabelledMesh::nodes_of(const Element& element) const {
  return {&element_node_[element.first_node], static_cast<std::size_t>(topology(element.shape).n_nodes)};
}

Index LabelledMesh::find_node(std::int64_t label, int line, const std::string& user) const {
  const Index node = node_place_.find(label);
  if (node < 0) refuse(line, user + " names node " + std::to_string(label) + ", which the file does not have");
  return node;
}

void LabelledMesh::make_blocks(SolidMesh& mesh) {
  if (element_.empty())
    throw report::SceneError(file_, "has no solid elements",
                             "save hexahedra with 20 or 8 nodes or tetrahedra with 10 nodes");
  std::map<std::pair<int, ElementShape>, std::size_t> block_place;
  std::vector<std::size_t> block_of(element_.size());
  for (std::size_t e = 0; e < element_.size(); ++e) {
    const Element& element = element_[e];
    const auto [place, is_new] = block_place.try_emplace({element.region, element.shape}, mesh.block.size());
    if (is_new) {
      ElementBlock& block = mesh.block.emplace_back();
      block.shape = element.shape;
      block.region = region_[static_cast<std::size_t>(element.region)];
    }
    block_of[e] = place->second;
    ElementBlock& block = mesh.block[place->second];
    block.label.push_back(element.label);
    block.line.push_back(element.line);
    for (const std::int64_t label : nodes_of(element))
      block.node.push_back(find_node(label, element.line, "element " + std::to_string(element.label)));
  }
  Index first = 0;
  for (ElementBlock& block : mesh.block) block.first_element = std::exchange(first, first + block.n_elements());
  std::vector<Index> next(mesh.block.size());
  for (std::size_t b = 0; b < next.size(); ++b) next[b] = mesh.block[b].first_element;
  number_.resize(element_.size());
  for (std::size_t e = 0; e < element_.size(); ++e) number_[e] = next[block_of[e]]++;
}

void LabelledMesh::make_axes(SolidMesh& mesh) const {
  for (const auto& [label, fibre] : fibre_) {
    const Index place = element_place_.find(label);
    if (place < 0)
      refuse(fibre.line, "a fibre is given for element " + std::to_string(label) + ", which the file does not have");
    const auto whose = " of element " + std::to_string(label);
    if (!(fibre.along.norm() > 0)) refuse(fibre.line, "the fibre" + whose + " has no direction");
    const Eigen::Vector3d along = fibre.along.normalized();
    Eigen::Vector3d across = fibre.across;
    if (across.isZero(0)) {
      Eigen::Index most_across = 0;
      along.cwiseAbs().minCoeff(&most_across);
      across = Eigen::Vector3d::Unit(most_across);
    }
    const Eigen::Vector3d perpendicular = across - along * along.dot(across);
    if (!(perpendicular.norm() > 1e-6 * across.norm()))
      refuse(fibre.line, "fibre and cross_fibre" + whose + " are parallel", "give two directions across each other");
    const Index number = number_[static_cast<std::size_t>(place)];
    const auto block = std::find_if(mesh.block.begin(), mesh.block.end(), [&](const ElementBlock& b) {
      return number >= b.first_element && number < b.first_element + b.n_elements();
    });
    block->axes.resize(static_cast<std::size_t>(block->n_elements()),
                       {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
    block->axes[static_cast<std::size_t>(number - block->first_element)] = {along, perpendicular.normalized()};
  }
  for (const ElementBlock& block : mesh.block)
    for (std::size_t e = 0; e < block.axes.size(); ++e)
      if (block.axes[e][0].isZero(0))
        refuse(block.line[e],
               "element " + std::to_string(block.label[e]) + " has no fibre, other elements of region \"" +
                   block.region + "\" have one",
               "give fibres for all elements of a region or for none");
}

void LabelledMesh::make_surfaces(SolidMesh& mesh) const {
  FaceSearch search;
  std::vector<std::pair<const Face*, FaceSearch::Key>> by_corners;
  for (const Face& face : face_) {
    const std::string user = "a face of surface \"" + face.surface + "\"";
    if (face.corner.empty()) {
      const Index place = element_place_.find(face.element);
      if (place < 0)
        refuse(face.line, user + " names element " + std::to_string(face.element) + ", which the file does not have");
      mesh.surface[face.surface].push_back({number_[static_cast<std::size_t>(place)], face.side});
      continue;
    }
    std::vector<Index> corners;
    for (const std::int64_t label : face.corner) corners.push_back(find_node(label, face.line, user));
    by_corners.emplace_back(&face, FaceSearch::key_of(corners));
    search.want(by_corners.back().second);
  }
  if (by_corners.empty()) return;
  search.sweep(mesh);
  for (const auto& [face, key] : by_corners) {
    const FaceSearch::Found found = search.find(key);
    if (found.n_elements == 0)
      refuse(face->line, "a face of surface \"" + face->surface + "\" belongs to no element",
             "save the solid elements too, with the same order");
    mesh.surface[face->surface].push_back(found.first);
  }
}

void LabelledMesh::make_node_sets(SolidMesh& mesh) const {
  for (const auto& [name, members] : node_set_) {
    std::vector<Index> nodes;
    for (const Member& member : members)
      nodes.push_back(find_node(member.node, member.line, "node set \"" + name + "\""));
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    if (nodes.size() == 1)
      mesh.marker[name] = nodes.front();
    else
      mesh.node_set[name] = std::move(nodes);
  }
}

SolidMesh LabelledMesh::finish() {
  SolidMesh mesh;
  mesh.node_position.resize(static_cast<Eigen::Index>(node_position_.size()), 3);
  for (std::size_t node = 0; node < node_position_.size(); ++node)
    mesh.node_position.row(static_cast<Eigen::Index>(node)) = node_position_[node];
  make_blocks(mesh);
  for (ElementBlock& block : mesh.block) block.file = file_;
  make_axes(mesh);
  make_surfaces(mesh);
  make_node_sets(mesh);
  return mesh;
}

}  // namespace couplet::solid
