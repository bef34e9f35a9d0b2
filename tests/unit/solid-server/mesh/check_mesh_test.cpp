#include "solid-server/mesh/check_mesh.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_conformity.hpp"
#include "solid-server/mesh/file/read_mesh.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "tests/unit/solid-server/mesh/file/mesh_texts.hpp"

namespace couplet::solid {
namespace {

std::string refusal(const SolidMesh& mesh) {
  try {
    check_mesh(mesh, "body");
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

SolidMesh box() {
  return make_box_mesh({{2, 1, 1}, {2, 1, 1}});
}

/// The box with the nodes of its second element in another order.
SolidMesh reordered(const std::vector<std::size_t>& order) {
  SolidMesh mesh = box();
  const std::vector<Index> nodes(mesh.nodes_of(1).begin(), mesh.nodes_of(1).end());
  for (std::size_t a = 0; a < order.size(); ++a) mesh.block[0].node[20 + a] = nodes[order[a]];
  mesh.surface.clear();
  return mesh;
}

const std::string wrong_order =
    "body: element 1 at (1.5, 0.5, 0.5) m: its nodes are in the wrong order; write them in the order of the file's "
    "format";

TEST(CheckMesh, AcceptsAGoodMesh) {
  EXPECT_EQ(refusal(box()), "accepted");
}

TEST(CheckMesh, RecognisesWrongOrders) {
  EXPECT_EQ(refusal(reordered({4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19})),
            wrong_order);  // mirrored
  EXPECT_EQ(refusal(reordered({0, 1, 3, 2, 4, 5, 7, 6, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19})),
            wrong_order);  // row by row
  EXPECT_EQ(refusal(reordered({0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14})),
            wrong_order);  // Gmsh
}

TEST(CheckMesh, RefusesInvertedAndFoldedElements) {
  SolidMesh mesh = box();
  mesh.surface.clear();
  const Index corner = mesh.nodes_of(1)[6];  // (2, 1, 1), pulled through the element
  mesh.node_position.row(corner) << 1.2, 0.2, 0.2;
  for (const std::size_t midside : {13u, 14u, 18u}) {
    const auto& edge = topology(ElementShape::hexahedron20).edge[midside - 8];
    mesh.node_position.row(mesh.nodes_of(1)[midside]) =
        (mesh.node_position.row(mesh.nodes_of(1)[static_cast<std::size_t>(edge[0])]) +
         mesh.node_position.row(mesh.nodes_of(1)[static_cast<std::size_t>(edge[1])])) /
        2;
  }
  const std::string text = refusal(mesh);
  EXPECT_TRUE(text.starts_with("body: element 1 at (")) << text;
  EXPECT_NE(text.find(": is folded: its Jacobian goes from -0."), std::string::npos) << text;
  EXPECT_NE(text.find(" m^3; it must be above 0 everywhere"), std::string::npos) << text;

  mesh = box();
  for (Index node = 0; node < mesh.n_nodes(); ++node) mesh.node_position(node, 2) = 0;  // flat
  EXPECT_NE(refusal(mesh).find("is inverted: its Jacobian is nowhere above 0"), std::string::npos);
}

TEST(CheckMesh, RefusesMidsideNodesFarFromTheMiddle) {
  SolidMesh mesh = box();
  const Index midside = mesh.nodes_of(0)[8];  // between (0, 0, 0) and (1, 0, 0)
  mesh.node_position(midside, 0) = 0.27;
  EXPECT_EQ(refusal(mesh), "accepted");
  mesh.node_position(midside, 0) = 0.2;
  EXPECT_EQ(
      refusal(mesh),
      "body: element 0 at (0.485, 0.5, 0.5) m: its node between corners 1 and 2 stands at 0.2 of the edge, 0.3 of its "
      "length from its middle; midside nodes must keep to the middle half");
}

TEST(CheckMesh, RefusesNodesThatAreUnusedDoubledOrNamedTwice) {
  SolidMesh mesh = box();
  mesh.node_position.conservativeResize(mesh.n_nodes() + 1, 3);
  mesh.node_position.row(mesh.n_nodes() - 1) << 5, 6, 7;
  EXPECT_EQ(refusal(mesh), "body: a node belongs to no element, the first at (5, 6, 7) m; leave them out");

  const SolidMesh joined = join_bodies({make_box_mesh({}), make_box_mesh({})}, {"a", "b"});
  EXPECT_NE(refusal(joined).find(
                "body: 20 nodes stand at the place of another one without being connected, the first at (0, 0, 0) m"),
            std::string::npos);

  mesh = box();
  mesh.block[0].node[25] = mesh.block[0].node[24];
  EXPECT_NE(refusal(mesh).find(": names a node twice"), std::string::npos);
  mesh.block[0].node[25] = 1000;
  EXPECT_EQ(refusal(mesh), "body: element 1 names node 1000 of a mesh of 32 nodes");
}

TEST(CheckMesh, RefusesAnElementThatIsThereTwice) {
  SolidMesh mesh = box();
  mesh.surface.clear();
  const std::vector<Index> nodes(mesh.nodes_of(1).begin(), mesh.nodes_of(1).end());
  mesh.block[0].node.insert(mesh.block[0].node.end(), nodes.begin(), nodes.end());
  EXPECT_EQ(refusal(mesh),
            "body: element 2 at (1.5, 0.5, 0.5) m: has the same corners as element 1 at (1.5, 0.5, 0.5) m; an element "
            "belongs to "
            "one region only");
}

TEST(CheckMesh, RefusesSurfacesThatAreNotOutside) {
  SolidMesh mesh = box();
  mesh.surface = {{"cut", {{0, hex20::xi_max}}},
                  {"empty", {}},
                  {"nowhere", {{7, 0}, {0, 6}}},
                  {"twice", {{0, hex20::xi_min}, {0, hex20::xi_min}}}};
  EXPECT_EQ(
      refusal(mesh),
      "body: surface \"cut\": 1 of its faces lie between two elements, the first at element 0 at (0.5, 0.5, 0.5) m; a "
      "surface must be on the outside\n"
      "body: surface \"empty\": has no faces\n"
      "body: surface \"nowhere\": 2 of its faces belong to no element\n"
      "body: surface \"twice\": 1 of its faces stand there twice, the first at element 0 at (0.5, 0.5, 0.5) m");
}

TEST(CheckMesh, RefusesElementsWithoutARegionBesideOthers) {
  SolidMesh mesh = box();
  ElementBlock second = mesh.block[0];
  mesh.block[0].node.resize(20);
  second.node.erase(second.node.begin(), second.node.begin() + 20);
  second.first_element = 1;
  mesh.block.push_back(second);
  mesh.block[0].region = "soft";
  EXPECT_EQ(refusal(mesh),
            "body: 1 elements belong to no region, the first is element 1 at (1.5, 0.5, 0.5) m; name a region for "
            "every element "
            "or for none");
}

/// The box whose second element has the nodes of another shape of hexahedron: corners only.
SolidMesh with_mixed_hexahedra() {
  SolidMesh mesh = box();
  ElementBlock linear;
  linear.shape = ElementShape::hexahedron8;
  linear.first_element = 1;
  linear.node.assign(mesh.block[0].node.begin() + 20, mesh.block[0].node.begin() + 28);
  mesh.block[0].node.resize(20);
  mesh.block.push_back(linear);
  return mesh;
}

TEST(CheckMesh, RefusesNeighboursThatShareCornersOnly) {
  const auto complaint = find_nonconforming(with_mixed_hexahedra());
  ASSERT_TRUE(complaint);
  EXPECT_NE(complaint->find("element 0 at (0.5, 0.5, 0.5) m (hexahedron20)"), std::string::npos) << *complaint;
  EXPECT_NE(complaint->find("element 1 at (1.5, 0.5, 0.5) m (hexahedron8)"), std::string::npos) << *complaint;
  EXPECT_NE(complaint->find("there are 3 more such places"), std::string::npos) << *complaint;  // four edges between
  EXPECT_NE(refusal(with_mixed_hexahedra()).find(*complaint), std::string::npos);
  EXPECT_FALSE(find_nonconforming(box()));
}

TEST(CheckMesh, RefusesTrianglesAgainstAQuadrilateral) {
  // A cube of 8 nodes, and a tetrahedron on half of its side x = 1 whose edges have their own midside nodes there but
  // for those of the square, which are straight: only the face tells.
  SolidMesh mesh = make_box_mesh({{1, 1, 1}, {1, 1, 1}});
  const auto at = [&](double x, double y, double z) {
    for (Index n = 0; n < mesh.n_nodes(); ++n)
      if ((mesh.node_position.row(n) - Eigen::RowVector3d(x, y, z)).norm() < 1e-12) return n;
    return Index{-1};
  };
  const Index a = at(1, 0, 0), b = at(1, 1, 0), c = at(1, 0, 1), ab = at(1, 0.5, 0), ac = at(1, 0, 0.5);
  const Index n = mesh.n_nodes();
  mesh.node_position.conservativeResize(n + 5, 3);
  mesh.node_position.bottomRows(5) << 2, 0, 0, 1, 0.5, 0.5, 1.5, 0, 0, 1.5, 0.5, 0, 1.5, 0, 0.5;
  ElementBlock tetrahedra;  // corners a, b, c and the apex n; midside nodes 0-1, 1-2, 2-0, 0-3, 1-3, 2-3
  tetrahedra.shape = ElementShape::tetrahedron10;
  tetrahedra.first_element = 1;
  tetrahedra.node = {a, b, c, n, ab, n + 1, ac, n + 2, n + 3, n + 4};
  mesh.block.push_back(tetrahedra);
  const auto complaint = find_nonconforming(mesh);
  ASSERT_TRUE(complaint);
  EXPECT_NE(complaint->find("one has a triangle where the other has a quadrilateral"), std::string::npos) << *complaint;
}

TEST(FindNodes, RefusesANameOfASurfaceAndOfOtherNodes) {
  SolidMesh mesh = box();
  mesh.node_set["x_min"] = mesh.find_nodes("x_min", "");
  EXPECT_EQ(mesh.find_nodes("x_min", "").size(), 8U);  // the same nodes: Gmsh writes both
  mesh.node_set["x_min"] = {0};
  try {
    mesh.find_nodes("x_min", "fixed[0]");
    ADD_FAILURE() << "accepted";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(
        error.what(),
        "fixed[0]: \"x_min\" is the name of a surface and of a node set of the mesh with other nodes; give one "
        "of them another name");
  }
}

TEST(CheckMesh, ShowsTenComplaintsAndCountsTheOthers) {
  SolidMesh mesh = make_box_mesh({{1, 1, 1}, {5, 5, 1}});
  mesh.node_position.col(2) *= -1;
  const std::string text = refusal(mesh);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_TRUE(text.ends_with("\nbody: and 15 more")) << text;
}

TEST(CheckConnected, WantsASupportInEveryPart) {
  SolidMesh far = make_box_mesh({});
  far.node_position.col(0).array() += 2;
  const SolidMesh mesh = join_bodies({make_box_mesh({}), far}, {"a", "b"});
  EXPECT_EQ(refusal(mesh), "accepted");
  EXPECT_EQ(find_parts(mesh).first_element, (std::vector<Index>{0, 1}));
  EXPECT_EQ(find_parts(mesh).part_of_node.at(25), 1);
  EXPECT_NO_THROW(check_connected(mesh, {3, 25}, "body"));
  try {
    check_connected(mesh, {3, 4}, "body");
    FAIL();
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(
        error.what(),
        "body: 1 of the 2 unconnected parts of the mesh have no support; the first begins with element 1 at (2.5, 0.5, "
        "0.5) m; merge the nodes of parts that belong together, or support each part");
  }
  EXPECT_NO_THROW(check_connected(make_box_mesh({}), {}, "body"));  // one part may fly
}

class ReadMesh : public testing::Test {
 protected:
  ReadMesh() : folder_(std::filesystem::temp_directory_path() / ("couplet_read_mesh_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~ReadMesh() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::filesystem::path folder_;
};

TEST_F(ReadMesh, ReadsByTheEndingAndChecks) {
  const TwoCubes cubes(1);
  EXPECT_EQ(read_mesh(write("m.msh", cubes.gmsh_4()), 1).mesh.n_elements(), 2);
  EXPECT_EQ(read_mesh(write("m.INP", cubes.abaqus()), 1).note,
            "skipped *MATERIAL, *ELASTIC, *STEP, *STATIC, *END STEP");
  EXPECT_THROW(read_mesh(write("m.stl", "solid"), 1), report::SceneError);
  EXPECT_THROW(read_mesh(folder_ / "absent.msh", 1), report::FileError);
  const auto bad = write("bad.inp", replaced(cubes.abaqus(), "2, 0.5, 0, 0\n", "2, 0.1, 0, 0\n"));
  try {
    read_mesh(bad, 1);
    FAIL();
  } catch (const report::SceneError& error) {
    EXPECT_EQ(std::string(error.what()).find(bad.string() + ": element 5 (" + bad.string() + ", line 38) at ("), 0u)
        << error.what();
  }
}

}  // namespace
}  // namespace couplet::solid
