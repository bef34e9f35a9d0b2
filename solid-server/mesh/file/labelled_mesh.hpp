#pragma once
// A mesh as mesh files tell it: nodes and elements by the numbers that they have there.

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

/// Places of labels in the order in which they were added. Labels that run on cost no search.
class LabelPlaces {
 public:
  /// False when the label is there already.
  bool add(std::int64_t label);
  /// -1 when there is none.
  Index find(std::int64_t label) const;
  Index size() const { return size_; }

 private:
  std::int64_t first_ = 0;                             // labels first_, first_ + 1, ... stand at places 0, 1, ...
  Index n_running_ = 0;                                // so many of them
  std::unordered_map<std::int64_t, Index> scattered_;  // the rest
  Index size_ = 0;
};

class LabelledMesh {
 public:
  LabelledMesh(std::string file, double length_unit) : file_(std::move(file)), length_unit_(length_unit) {}

  /// Each throws SceneError with file and line when the label is there already.
  void add_node(std::int64_t label, const Eigen::Vector3d& position, int line);
  /// Nodes in the order of ElementShape.
  void add_element(std::int64_t label, ElementShape shape, const std::string& region,
                   std::span<const std::int64_t> nodes, int line);

  /// A face by its corners, in any order and with either normal.
  void add_face(const std::string& surface, std::span<const std::int64_t> corners, int line);
  /// A face by its element and its place in the topology's faces.
  void add_side(const std::string& surface, std::int64_t element, int side, int line);
  void add_to_node_set(const std::string& set, std::int64_t node, int line);
  void set_fibre(std::int64_t element, const Eigen::Vector3d& direction, int line);
  void set_cross_fibre(std::int64_t element, const Eigen::Vector3d& direction, int line);

  Index n_elements() const { return element_place_.size(); }
  bool has_element(std::int64_t label) const { return element_place_.find(label) >= 0; }
  int n_faces_of(std::int64_t element) const;
  void set_region(std::int64_t element, const std::string& region);

  /// Everything with its own numbers. Elements of one region and shape are one block, in the order of their first
  /// elements. A node set of one node becomes a marker. Fibres become axes; without cross-fibres the second axis is the
  /// global axis most across the fibre, made perpendicular to it. Throws SceneError with file and line for labels that
  /// do not exist, for faces without an element, and for fibres of some elements of a block only.
  SolidMesh finish();

 private:
  struct Element {
    std::int64_t label;
    ElementShape shape;
    int region;              // place in region_
    std::size_t first_node;  // place in element_node_
    int line;
  };
  struct Face {
    std::string surface;
    std::vector<std::int64_t> corner;  // by corners, or
    std::int64_t element;              // by element and side
    int side, line;
  };
  struct Member {
    std::int64_t node;
    int line;
  };
  struct Fibre {
    Eigen::Vector3d along = Eigen::Vector3d::Zero(), across = Eigen::Vector3d::Zero();
    int line = 0;
  };

  [[noreturn]] void refuse(int line, const std::string& sentence, const std::string& advice = {}) const;
  int region_place(const std::string& region);
  std::span<const std::int64_t> nodes_of(const Element& element) const;
  Index find_node(std::int64_t label, int line, const std::string& user) const;
  void make_blocks(SolidMesh& mesh);
  void make_axes(SolidMesh& mesh) const;
  void make_surfaces(SolidMesh& mesh) const;
  void make_node_sets(SolidMesh& mesh) const;

  std::string file_;
  double length_unit_;
  LabelPlaces node_place_, element_place_;
  std::vector<Eigen::Vector3d> node_position_;
  std::vector<Element> element_;
  std::vector<std::int64_t> element_node_;
  std::vector<std::string> region_;
  std::vector<Face> face_;
  std::map<std::string, std::vector<Member>> node_set_;
  std::map<std::int64_t, Fibre> fibre_;  // by element
  std::vector<Index> number_;            // of each element in the mesh, by its place here
};

}  // namespace couplet::solid
