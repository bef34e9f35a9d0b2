#include "solid-server/mesh/file/read_gmsh.hpp"

#include <gtest/gtest.h>

#include <random>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_mesh.hpp"
#include "solid-server/mesh/file/read_abaqus.hpp"
#include "tests/unit/solid-server/mesh/file/mesh_texts.hpp"
#include "tests/unit/solid-server/mesh/mesh_measures.hpp"

namespace couplet::solid {
namespace {

/// A unit cube with 20 nodes as Gmsh 4.8 saves it, node numbers and all.
const char* const saved_by_gmsh = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
3
0 4 "origin"
2 2 "left"
3 1 "tissue"
$EndPhysicalNames
$Entities
1 0 1 1
2 0 0 0 1 4 
1 -1e-07 -9.9e-08 -9.9e-08 1e-07 1.0000001 1.0000001 1 2 4 1 2 -3 -4 
1 -9.9e-08 -9.9e-08 -9.9e-08 1.0000001 1.0000001 1.0000001 1 1 6 1 2 3 4 5 6 
$EndEntities
$Nodes
2 20 1 20
0 1 0 1
1
0 0 1
3 1 0 19
2
3
4
5
6
7
8
9
10
11
12
13
14
15
16
17
18
19
20
0 0 0
0 1 1
0 1 0
1 0 1
1 0 0
1 1 1
1 1 0
0 0 0.4999999999999999
0 0.4999999999999999 1
0 1 0.4999999999999999
0 0.4999999999999999 0
1 0 0.4999999999999999
1 0.4999999999999999 1
1 1 0.4999999999999999
1 0.4999999999999999 0
0.4999999999999999 0 0
0.4999999999999999 0 1
0.4999999999999999 1 0
0.4999999999999999 1 1
$EndNodes
$Elements
3 3 1 5
0 2 15 1
1 2 
2 1 16 1
3 2 1 3 4 9 10 11 12 
3 1 17 1
5 3 1 2 4 7 5 6 8 10 11 20 9 18 12 17 19 14 15 13 16 
$EndElements
)";

/// One tetrahedron with 10 nodes; its last two midside nodes in Gmsh's order: between corners 3-4, then 2-4.
const char* const tetrahedron = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
10
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 .5 0 0
6 .5 .5 0
7 0 .5 0
8 0 0 .5
9 0 .5 .5
10 .5 0 .5
$EndNodes
$Elements
2
1 9 2 7 1 1 3 2 7 6 5
2 11 2 8 1 1 2 3 4 5 6 7 8 9 10
$EndElements
)";

std::string refusal_of_gmsh(const std::string& text) {
  try {
    check_mesh(read_gmsh(text, "m.msh", 1), "m.msh");
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<std::pair<Index, int>> faces(const SolidMesh& mesh, const std::string& name) {
  std::vector<std::pair<Index, int>> out;
  for (const ElementFace& face : mesh.surface.at(name)) out.emplace_back(face.element, face.side);
  return out;
}

void expect_two_cubes(const SolidMesh& mesh, double edge) {
  const TwoCubes cubes(edge);
  EXPECT_EQ(mesh.node_position.rows(), cubes.mesh.node_position.rows());
  EXPECT_LE((mesh.node_position - cubes.mesh.node_position).cwiseAbs().maxCoeff(), 1e-16 * edge);
  ASSERT_EQ(mesh.block.size(), 2u);
  EXPECT_EQ(mesh.block[0].region, "soft");
  EXPECT_EQ(mesh.block[1].region, "stiff");
  for (const Index e : {0, 1}) {
    const auto got = mesh.nodes_of(e), wanted = cubes.mesh.nodes_of(e);
    EXPECT_TRUE(std::equal(got.begin(), got.end(), wanted.begin(), wanted.end()));
    EXPECT_EQ(mesh.block[static_cast<std::size_t>(e)].label, std::vector<std::int64_t>{e + 5});
  }
  EXPECT_EQ(faces(mesh, "left"), (std::vector<std::pair<Index, int>>{{0, hex20::xi_min}}));
  EXPECT_EQ(faces(mesh, "right"), (std::vector<std::pair<Index, int>>{{1, hex20::xi_max}}));
  EXPECT_EQ(mesh.surface.size(), 2u);
  std::vector<Index> line;
  for (const Index label : cubes.edge_node) line.push_back(label - 1);
  std::sort(line.begin(), line.end());
  EXPECT_EQ(mesh.node_set.at("edge"), line);
  EXPECT_EQ(mesh.marker.at("corner"), cubes.edge_node[0] - 1);
  EXPECT_NO_THROW(check_mesh(mesh, "m"));
}

TEST(MeshFiles, AreTheSameMeshInEveryFormat) {
  const TwoCubes cubes(1);
  expect_two_cubes(read_gmsh(cubes.gmsh_4(), "m.msh", 1), 1);
  expect_two_cubes(read_gmsh(cubes.gmsh_2(), "m.msh", 1), 1);
  expect_two_cubes(read_abaqus(cubes.abaqus(), "m.inp", 1).mesh, 1);
}

TEST(MeshFiles, MayHaveLinesThatEndAsOnWindows) {
  const TwoCubes cubes(1);
  expect_two_cubes(read_gmsh(with_crlf(cubes.gmsh_4()), "m.msh", 1), 1);
  expect_two_cubes(read_gmsh(with_crlf(cubes.gmsh_2()), "m.msh", 1), 1);
  expect_two_cubes(read_abaqus(with_crlf(cubes.abaqus()), "m.inp", 1).mesh, 1);
}

TEST(MeshFiles, MayBeInMillimetres) {
  const TwoCubes cubes(8);
  expect_two_cubes(read_gmsh(cubes.gmsh_4(), "m.msh", 1e-3), 8e-3);
  expect_two_cubes(read_gmsh(cubes.gmsh_2(), "m.msh", 1e-3), 8e-3);
  expect_two_cubes(read_abaqus(cubes.abaqus(), "m.inp", 1e-3).mesh, 8e-3);
}

TEST(MeshFiles, EndInARefusalWhereverTheyAreCutOff) {
  const TwoCubes cubes(1);
  // Only blanks and what follows the last element of the Abaqus file can be missing without harm.
  for (const std::string& whole : {cubes.gmsh_4(), cubes.gmsh_2()}) {
    const std::size_t last = whole.find("$EndElements") + std::string("$EndElements").size();
    for (std::size_t length = 0; length < last; ++length)
      EXPECT_THROW(read_gmsh(whole.substr(0, length), "m.msh", 1), report::SceneError) << length;
  }
  const std::string whole = cubes.abaqus();
  const std::size_t last = whole.find("*Element, type=C3D20, elset=stiff") - 10;
  for (std::size_t length = 0; length < last; ++length)
    EXPECT_THROW(read_abaqus(whole.substr(0, length), "m.inp", 1), report::SceneError) << length;
}

TEST(MeshFiles, OfRandomBytesAreRefused) {
  std::mt19937 random(7);
  for (int attempt = 0; attempt < 200; ++attempt) {
    std::string text(static_cast<std::size_t>(random() % 3000), '\0');
    for (char& c : text) c = static_cast<char>(random() % 256);
    EXPECT_THROW(read_gmsh(text, "m.msh", 1), report::SceneError);
    EXPECT_THROW(read_gmsh("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n" + text, "m.msh", 1), report::SceneError);
    EXPECT_THROW(read_abaqus(text, "m.inp", 1), report::SceneError);
    EXPECT_THROW(read_abaqus("*ELEMENT, TYPE=C3D8\n" + text, "m.inp", 1), report::SceneError);
  }
}

TEST(MeshFiles, WithOneWrongByteAreReadOrRefusedButNothingElse) {
  const TwoCubes cubes(1);
  std::mt19937 random(11);
  const std::vector<std::string> texts = {cubes.gmsh_4(), cubes.gmsh_2(), cubes.abaqus()};
  for (int attempt = 0; attempt < 6000; ++attempt) {
    std::string text = texts[static_cast<std::size_t>(attempt % 3)];
    text[random() % text.size()] = "0123456789-.,*$\n e\"S"[random() % 20];
    try {
      const SolidMesh mesh = attempt % 3 == 2 ? read_abaqus(text, "m", 1).mesh : read_gmsh(text, "m", 1);
      check_mesh(mesh, "m");
    } catch (const report::SceneError&) {  // anything else ends the test
    }
  }
}

TEST(ReadGmsh, ReadsWhatGmshSaves) {
  const SolidMesh mesh = read_gmsh(saved_by_gmsh, "m.msh", 1);
  EXPECT_NO_THROW(check_mesh(mesh, "m.msh"));  // midside nodes in a wrong order would be far from their edges
  EXPECT_NEAR(volume_of(mesh), 1, 1e-14);      // rounding
  EXPECT_NEAR(area_vector_of(mesh, "left").x(), -1, 1e-14);
  EXPECT_EQ(mesh.block.front().region, "tissue");
  EXPECT_EQ(mesh.marker.at("origin"), 1);
  EXPECT_EQ(mesh.describe_element(0), "element 5 (m.msh, line 68) at (0.5, 0.5, 0.5) m");
}

TEST(ReadGmsh, ReadsTetrahedraAndGroupsWithoutNames) {
  const SolidMesh mesh = read_gmsh(tetrahedron, "m.msh", 1);
  EXPECT_NO_THROW(check_mesh(mesh, "m.msh"));
  EXPECT_NEAR(volume_of(mesh), 1.0 / 6, 1e-14);
  EXPECT_EQ(mesh.block.front().shape, ElementShape::tetrahedron10);
  EXPECT_EQ(mesh.block.front().region, "8");
  EXPECT_NEAR(area_vector_of(mesh, "7").z(), -0.5, 1e-15);
}

TEST(ReadGmsh, ReadsFibres) {
  const std::string fibre = R"($ElementData
1
"fibre"
1
0.0
3
0
3
2
5 0 2 0
6 0 0 -1
$EndElementData
)";
  const std::string cross =
      replaced(replaced(replaced(fibre, "\"fibre\"", "\"cross_fibre\""), "5 0 2 0", "5 1 1 0"), "0 0 -1", "0 1 0");
  const std::string text = TwoCubes(1).gmsh_2();
  const SolidMesh alone = read_gmsh(text + fibre, "m.msh", 1);
  EXPECT_EQ(alone.block[0].axes.at(0)[0], Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(alone.block[1].axes.at(0)[0], Eigen::Vector3d(0, 0, -1));
  EXPECT_NEAR(alone.block[0].axes.at(0)[1].dot(Eigen::Vector3d(0, 1, 0)), 0, 1e-16);
  const SolidMesh both = read_gmsh(text + fibre + cross, "m.msh", 1);
  EXPECT_EQ(both.block[0].axes.at(0)[1], Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(both.block[1].axes.at(0)[1], Eigen::Vector3d(0, 1, 0));
  const SolidMesh other = read_gmsh(text + replaced(fibre, "\"fibre\"", "\"stress\""), "m.msh", 1);
  EXPECT_TRUE(other.block[0].axes.empty());
  EXPECT_EQ(refusal_of_gmsh(text + replaced(fibre, "0 2 0", "0 0 0")),
            "m.msh:66: the fibre of element 5 has no direction");
  EXPECT_EQ(refusal_of_gmsh(text + replaced(fibre, "6 0 0 -1", "9 0 0 -1")),
            "m.msh:67: a fibre is given for element 9, which the file does not have");
  EXPECT_EQ(refusal_of_gmsh(text + replaced(fibre, "0\n3\n2", "0\n1\n2")),
            "m.msh:65: the data \"fibre\" have 1 numbers an element; give directions: 3 numbers");
  EXPECT_EQ(refusal_of_gmsh(text + fibre + replaced(cross, "5 1 1 0", "5 0 1 0")),
            "m.msh:66: fibre and cross_fibre of element 5 are parallel; give two directions across each other");
}

TEST(ReadGmsh, RefusesFibresOfSomeElementsOfARegion) {
  std::string text = replaced(TwoCubes(1).gmsh_2(), "6 17 2 6 2", "6 17 2 5 2");
  text += "$ElementData\n1\n\"fibre\"\n1\n0\n3\n0\n3\n1\n6 1 0 0\n$EndElementData\n";
  EXPECT_EQ(refusal_of_gmsh(text),
            "m.msh:54: element 5 has no fibre, other elements of region \"soft\" have one; give fibres for all "
            "elements of a region or for none");
}

TEST(ReadGmsh, RefusesWithLineValueAndRemedy) {
  const std::string four = TwoCubes(1).gmsh_4(), two = TwoCubes(1).gmsh_2();
  EXPECT_EQ(refusal_of_gmsh(""), "m.msh:1: the file is empty; give a mesh saved by Gmsh");
  EXPECT_EQ(refusal_of_gmsh("solid cube\n"),
            "m.msh:1: this is not a Gmsh mesh: it does not begin with $MeshFormat; save the mesh as .msh, version 4.1");
  EXPECT_EQ(refusal_of_gmsh(replaced(four, "4.1 0 8", "4.1 1 8")),
            "m.msh:2: the file is binary; set Mesh.Binary=0 and save again");
  EXPECT_EQ(refusal_of_gmsh(replaced(four, "4.1 0 8", "4 0 8")),
            "m.msh:2: version 4 of the format is not read; set Mesh.MshFileVersion=4.1 and save again");
  const std::string remedy = "; set Mesh.ElementOrder=2 and Mesh.SecondOrderIncomplete=1, and save again";
  EXPECT_EQ(refusal_of_gmsh(replaced(four, "3 1 17 1", "3 1 4 1")),
            "m.msh:100: elements of type 4 (4-node tetrahedron) are not read" + remedy);
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "5 17 2", "5 12 2")),
            "m.msh:54: elements of type 12 (27-node hexahedron) are not read; set Mesh.SecondOrderIncomplete=1 and "
            "save again");
  EXPECT_EQ(
      refusal_of_gmsh(replaced(two, "5 17 2", "5 18 2")),
      "m.msh:54: elements of type 18 (15-node prism) are not read; mesh the volumes with hexahedra or tetrahedra only");
  EXPECT_EQ(
      refusal_of_gmsh(replaced(two, "5 17 2", "5 7 2")),
      "m.msh:54: elements of type 7 (5-node pyramid) are not read; mesh the volumes with hexahedra or tetrahedra only");
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "5 17 2", "5 92 2")), "m.msh:54: elements of type 92 are not read" + remedy);
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "3 16 2", "3 10 2")),
            "m.msh:52: elements of type 10 (9-node quadrilateral) are not read; set Mesh.SecondOrderIncomplete=1 and "
            "save again");
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "\n2 0.5 0 0\n", "\n2 0.5 0 zero\n")),
            "m.msh:16: \"zero\" is not a number for the place of a node");
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "\n2 0.5 0 0\n", "\n2 0.5 0\n")),
            "m.msh:16: the line ends before the place of a node");
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "\n2 0.5 0 0\n", "\n1 0.5 0 0\n")),
            "m.msh:16: node 1 is there twice; give every node its own number");
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "\n2 0.5 0 0\n", "\n99 0.5 0 0\n")),
            "m.msh:54: element 5 names node 2, which the file does not have");
  EXPECT_EQ(
      refusal_of_gmsh(replaced(two, "6 17 2", "5 17 2")),
      "m.msh:55: element 5 is there twice; give every element its own number; an element belongs to one region only");
  EXPECT_EQ(refusal_of_gmsh(replaced(four, "1 0 0 0 1 1 1 1 5 0", "1 0 0 0 1 1 1 2 5 6 0")),
            "m.msh:101: element 5 belongs to the physical volumes \"soft\" and \"stiff\"; put every volume into one "
            "physical volume");
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "$EndNodes", "33 0 0 0\n$EndNodes")),
            "m.msh:47: here $EndNodes should stand; the numbers of lines before it are wrong");
  EXPECT_EQ(refusal_of_gmsh(replaced(two, "$EndElements\n", "")),
            "m.msh:55: the file ends before $EndElements; the file is cut off: write it again");
  EXPECT_EQ(refusal_of_gmsh("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"),
            "m.msh: has no solid elements; save hexahedra with 20 or 8 nodes or tetrahedra with 10 nodes");
  EXPECT_EQ(refusal_of_gmsh(replaced(four, "$Entities\n", "$PartitionedEntities\n")),
            "m.msh:13: the mesh is partitioned; save it without partitions");
}

TEST(ReadGmsh, RefusesAFaceOfNoElement) {
  // The tetrahedron's face with a corner that it does not have.
  std::string text = replaced(tetrahedron, "1 9 2 7 1 1 3 2 7 6 5", "1 9 2 7 1 1 3 5 7 6 5");
  EXPECT_EQ(
      refusal_of_gmsh(text),
      "m.msh:19: a face of surface \"7\" belongs to no element; save the solid elements too, with the same order");
}

}  // namespace
}  // namespace couplet::solid
