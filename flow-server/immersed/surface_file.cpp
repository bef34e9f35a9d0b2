#include "flow-server/immersed/surface_file.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <map>
#include <string>
#include <vector>

#include "proto/report/failure.hpp"

namespace couplet::flow {
namespace {

std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

using Position = std::array<double, 3>;

}  // namespace

surface::SurfaceMesh read_surface_file(const std::filesystem::path& file, double scale) {
  const std::string ending = ending_of(file);
  if (ending != ".stl" && ending != ".obj" && ending != ".ply") {
    throw report::FileError(file.string(), "is not a surface that can be read: its name ends in '" + ending + "'",
                            "give a file that ends in .stl, .obj or .ply");
  }
  if (!std::filesystem::is_regular_file(file))
    throw report::FileError(file.string(), "there is no such file", "check the path of the surface");
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices);
  if (scene == nullptr) {
    throw report::FileError(file.string(), std::string("cannot be read as a surface: ") + importer.GetErrorString(),
                            "write it anew, as binary STL for example");
  }

  std::vector<Position> position;                 // of nodes
  std::vector<std::array<std::int64_t, 3>> face;  // nodes
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const std::size_t first = position.size();
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      // Adding zero makes -0 and 0 the same place.
      position.push_back({scale * static_cast<double>(p.x) + 0.0, scale * static_cast<double>(p.y) + 0.0,
                          scale * static_cast<double>(p.z) + 0.0});
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& polygon = part.mFaces[f];
      if (polygon.mNumIndices != 3) continue;  // points and lines
      face.push_back({});
      for (unsigned k = 0; k < 3; ++k) face.back()[k] = static_cast<std::int64_t>(first + polygon.mIndices[k]);
    }
  }

  // One node for each place: number the places in the order in which the file names them.
  std::vector<std::size_t> by_place(position.size());
  for (std::size_t i = 0; i < by_place.size(); ++i) by_place[i] = i;
  std::sort(by_place.begin(), by_place.end(), [&](std::size_t a, std::size_t b) {
    return position[a] != position[b] ? position[a] < position[b] : a < b;
  });
  std::vector<std::size_t> first_at(position.size());
  for (std::size_t i = 0; i < by_place.size(); ++i) {
    const bool is_same = i > 0 && position[by_place[i]] == position[by_place[i - 1]];
    first_at[by_place[i]] = is_same ? first_at[by_place[i - 1]] : by_place[i];
  }
  std::vector<std::int64_t> node(position.size(), -1);
  std::vector<Position> place;
  std::vector<std::int64_t> face_node;
  for (const auto& corners : face) {
    std::array<std::int64_t, 3> nodes{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t first = first_at[static_cast<std::size_t>(corners[k])];
      if (node[first] < 0) {
        node[first] = static_cast<std::int64_t>(place.size());
        place.push_back(position[first]);
      }
      nodes[k] = node[first];
    }
    if (nodes[0] == nodes[1] || nodes[1] == nodes[2] || nodes[2] == nodes[0]) continue;
    face_node.insert(face_node.end(), nodes.begin(), nodes.end());
  }
  if (face_node.empty()) throw report::FileError(file.string(), "holds no triangles", "give a file with a surface");

  surface::SurfaceMesh mesh;
  const auto n_faces = static_cast<Eigen::Index>(face_node.size() / 3);
  mesh.node_position.resize(static_cast<Eigen::Index>(place.size()), 3);
  for (std::size_t i = 0; i < place.size(); ++i)
    for (std::size_t d = 0; d < 3; ++d)
      mesh.node_position(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d)) = place[i][d];
  mesh.face_node = Eigen::Map<const surface::IndexArray>(face_node.data(), 3 * n_faces);
  mesh.face_offset = surface::IndexArray::LinSpaced(n_faces + 1, 0, 3 * n_faces);
  mesh.face_region.setZero(n_faces);
  mesh.region = {file.stem().string()};
  return mesh;
}

}  // namespace couplet::flow
