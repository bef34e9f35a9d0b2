#include "solid-server/mesh/file/read_abaqus.hpp"

#include <gtest/gtest.h>

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_mesh.hpp"
#include "tests/unit/solid-server/mesh/file/mesh_texts.hpp"
#include "tests/unit/solid-server/mesh/mesh_measures.hpp"

namespace couplet::solid {
namespace {

/// Three cubes with 8 nodes in a row along x, labels 10, 20, 30.
const char* const three_cubes = R"(*NODE, NSET=all
1, 0, 0, 0
2, 0, 1, 0
3, 0, 1, 1
4, 0, 0, 1
5, 1, 0, 0
6, 1, 1, 0
7, 1, 1, 1
8, 1, 0, 1
9, 2
10, 2, 1
11, 2, 1, 1
12, 2, 0, 1
13, 3, 0, 0
14, 3, 1, 0
15, 3, 1, 1
16, 3, 0, 1
*ELEMENT, TYPE=C3D8R, ELSET=everything
10, 1, 5, 6, 2, 4, 8, 7, 3
20, 5, 9, 10, 6, 8, 12, 11, 7
30, 9, 13, 14, 10,
12, 16, 15, 11
)";

std::string refusal_of_abaqus(const std::string& text) {
  try {
    check_mesh(read_abaqus(text, "m.inp", 1).mesh, "m.inp");
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<std::string> regions(const std::string& more) {
  const SolidMesh mesh = read_abaqus(three_cubes + more, "m.inp", 1).mesh;
  std::vector<std::string> out;
  for (Index element = 0; element < 3; ++element)
    for (const ElementBlock& block : mesh.block)
      for (std::size_t e = 0; e < block.label.size(); ++e)
        if (block.label[e] == 10 * (element + 1)) out.push_back(block.region);
  return out;
}

TEST(ReadAbaqus, ReadsEightNodesAndCoordinatesThatAreLeftOut) {
  const SolidMesh mesh = read_abaqus(three_cubes, "m.inp", 1).mesh;
  EXPECT_NO_THROW(check_mesh(mesh, "m.inp"));
  EXPECT_NEAR(volume_of(mesh), 3, 1e-14);
  EXPECT_EQ(mesh.node_set.at("all").size(), 16u);
  EXPECT_EQ(mesh.block.front().line.at(2), 21);
}

TEST(ReadAbaqus, MakesSurfacesOfSurfaceElementsAsGmshWritesThem) {
  const SolidMesh mesh = read_abaqus(std::string(three_cubes) + R"(*ELEMENT, type=T3D2, ELSET=Line1
1, 1, 2
*ELEMENT, type=CPS4, ELSET=Surface1
2, 1, 2, 3, 4
*ELEMENT, type=CPS4, ELSET=Surface2
3, 13, 14, 15, 16
*ELSET, ELSET=ends
2, 3
*ELSET, ELSET=all_of_it
1, 2, 3, 10, 20, 30
)",
                                     "m.inp", 1)
                             .mesh;
  ASSERT_EQ(mesh.surface.size(), 4U);  // one for each set
  for (const char* name : {"ends", "all_of_it"}) {
    double x = 0;
    ASSERT_EQ(mesh.find_surface(name, "").size(), 2U);
    for (const ElementFace& face : mesh.find_surface(name, ""))
      for (const Index node : mesh.nodes_of(face)) x += mesh.node_position(node, 0);
    EXPECT_EQ(x, 12) << name;  // four corners at x = 0, four at x = 3
  }
  EXPECT_EQ(mesh.find_surface("Surface2", "").size(), 1U);
  EXPECT_EQ(mesh.n_elements(), 3);
  EXPECT_EQ(mesh.block.front().region, "everything");
}

TEST(ReadAbaqus, RefusesASurfaceElementThatIsNoFace) {
  EXPECT_NE(
      refusal_of_abaqus(std::string(three_cubes) + "*ELEMENT, type=S4, ELSET=skin\n2, 1, 2, 3, 9\n").find("m.inp:24"),
      std::string::npos);
}

TEST(ReadAbaqus, TakesRegionsFromTheElementsUnlessSetsPartThem) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(regions(""), (Names{"everything", "everything", "everything"}));
  EXPECT_EQ(regions("*ELSET, ELSET=ends\n10, 30\n"), (Names{"everything", "everything", "everything"}));
  EXPECT_EQ(regions("*ELSET, ELSET=Ends\n10, 30\n*ELSET, ELSET=middle\n20\n*ELSET, ELSET=ALL\neverything\n"),
            (Names{"Ends", "middle", "Ends"}));
  EXPECT_EQ(regions("*ELSET, ELSET=ends, GENERATE\n10, 30, 20\n*ELSET, ELSET=two, GENERATE\n20, 30, 10\n"),
            (Names{"everything", "everything", "everything"}));  // element 30 is in both
  EXPECT_EQ(regions("*ELSET, ELSET=a\n10\n*ELSET, ELSET=b\n20\n30\n*ELSET, ELSET=_side, INTERNAL\n20\n"),
            (Names{"a", "b", "b"}));
  EXPECT_EQ(
      regions("*ELSET, ELSET=a\n10\n*ELSET, ELSET=b\n20, 30\n*ELSET, ELSET=side\n30\n*SURFACE, NAME=s\nside, S4\n"),
      (Names{"a", "b", "b"}));
}

TEST(ReadAbaqus, KnowsEverySideOfAHexahedron) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  const std::vector<Eigen::Vector3d> normals = {-z, z, -y, x, y, -x};
  for (std::size_t s = 0; s < 6; ++s) {
    const std::string text =
        three_cubes + std::string("*SURFACE, NAME=side, TYPE=ELEMENT\n30, S") + std::to_string(s + 1) + "\n";
    EXPECT_LE((area_vector_of(read_abaqus(text, "m.inp", 1).mesh, "side") - normals[s]).norm(), 1e-15) << s + 1;
  }
}

TEST(ReadAbaqus, KnowsEverySideOfATetrahedron) {
  const std::string text =
      "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,.5,0,0\n6,.5,.5,0\n7,0,.5,0\n8,0,0,.5\n9,.5,0,.5\n10,0,.5,.5\n"
      "*ELEMENT, TYPE=C3D10\n1,1,2,3,4,5,6,7,8,9,10\n*SURFACE, NAME=side\n1, S";
  const std::vector<Eigen::Vector3d> areas = {{0, 0, -.5}, {0, -.5, 0}, {.5, .5, .5}, {-.5, 0, 0}};
  for (std::size_t s = 0; s < 4; ++s) {
    const SolidMesh mesh = read_abaqus(text + std::to_string(s + 1) + "\n", "m.inp", 1).mesh;
    EXPECT_NO_THROW(check_mesh(mesh, "m.inp"));
    EXPECT_NEAR(volume_of(mesh), 1.0 / 6, 1e-14);  // rounding
    EXPECT_LE((area_vector_of(mesh, "side") - areas[s]).norm(), 1e-15) << s + 1;
  }
  EXPECT_EQ(refusal_of_abaqus(text + "5\n"), "m.inp:15: surface \"side\" names side S5 of element 1; write S1 to S4");
}

TEST(ReadAbaqus, ReadsSetsOfSetsAndSurfacesOfNodes) {
  const SolidMesh mesh = read_abaqus(three_cubes + std::string(R"(*NSET, NSET=left, GENERATE
1, 4
*nset, nset=Right
13, 14, 15, 16
*NSET, NSET=ends
LEFT, right
*SURFACE, NAME=touching, TYPE=NODE
ends, 1.
5,
*NSET, NSET=tip
16,
)"),
                                     "m.inp", 1)
                             .mesh;
  EXPECT_EQ(mesh.node_set.at("ends"), (std::vector<Index>{0, 1, 2, 3, 12, 13, 14, 15}));
  EXPECT_EQ(mesh.node_set.at("touching"), (std::vector<Index>{0, 1, 2, 3, 4, 12, 13, 14, 15}));
  EXPECT_EQ(mesh.node_set.count("Right"), 1u);
  EXPECT_EQ(mesh.marker.at("tip"), 15);
}

TEST(ReadAbaqus, TakesASetThatNamesItselfOnce) {
  // Each line would double the set, and forty of them fill any memory.
  std::string text = std::string(three_cubes) + "*NSET, NSET=ring\n1, 2\n";
  for (int n = 0; n < 40; ++n) text += "ring\n";
  EXPECT_EQ(read_abaqus(text, "m.inp", 1).mesh.node_set.at("ring"), (std::vector<Index>{0, 1}));
}

TEST(ReadAbaqus, SaysOnceWhichKeywordsItSkips) {
  const MeshReading reading = read_abaqus(
      three_cubes + std::string("*MATERIAL, NAME=A\n*ELASTIC\n1, .3\n*Material, name=B\n*STEP\n*END STEP\n"), "m.inp",
      1);
  EXPECT_EQ(reading.note, "skipped *MATERIAL, *ELASTIC, *STEP, *END STEP");
  EXPECT_EQ(read_abaqus(three_cubes, "m.inp", 1).note, "");
}

TEST(ReadAbaqus, ReadsOnePartAndItsAssembly) {
  const std::string text =
      "*PART, NAME=P\n" + std::string(three_cubes) +
      "*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n*END INSTANCE\n*NSET, NSET=tip, INSTANCE=P-1\n16,\n"
      "*NSET, NSET=root\nP-1.1, P-1.2\n*END ASSEMBLY\n";
  const MeshReading reading = read_abaqus(text, "m.inp", 1);
  EXPECT_EQ(reading.mesh.marker.at("tip"), 15);
  EXPECT_EQ(reading.mesh.node_set.at("root"), (std::vector<Index>{0, 1}));
  EXPECT_EQ(reading.note, "");
  EXPECT_EQ(refusal_of_abaqus(replaced(text, "*END INSTANCE", "1., 0., 0.\n*END INSTANCE")),
            "m.inp:27: the instance is moved; save a flat input file, without parts and assemblies");
  EXPECT_EQ(refusal_of_abaqus(replaced(text, "*END INSTANCE", "*END INSTANCE\n*INSTANCE, NAME=P-2, PART=P")),
            "m.inp:28: the file has several instances of parts; save a flat input file, without parts and assemblies");
}

TEST(ReadAbaqus, RefusesWithLineValueAndRemedy) {
  const std::string good = three_cubes;
  EXPECT_EQ(refusal_of_abaqus(""),
            "m.inp:1: this is not an input file of Abaqus or CalculiX: no line begins with a keyword such as "
            "*NODE; save the mesh as .inp");
  EXPECT_EQ(refusal_of_abaqus(replaced(good, "C3D8R", "C3D15")),
            "m.inp:18: elements of type C3D15 are not read; use C3D20, C3D20R, C3D8, C3D8R, C3D8I or C3D10");
  EXPECT_EQ(refusal_of_abaqus(replaced(good, "TYPE=C3D8R, ", "")),
            "m.inp:18: *ELEMENT has no TYPE; write *ELEMENT, TYPE=...");
  EXPECT_EQ(refusal_of_abaqus(replaced(good, "12, 16, 15, 11", "12, 16, 15")),
            "m.inp:21: element 30 has 7 nodes; C3D8R has 8");
  EXPECT_EQ(refusal_of_abaqus(replaced(good, "20, 5, 9, 10", "20, 5, 9, 99")),
            "m.inp:20: element 20 names node 99, which the file does not have");
  EXPECT_EQ(refusal_of_abaqus(replaced(good, "20, 5, 9, 10", "20, 5, 9.5, 10")),
            "m.inp:20: \"9.5\" is not a whole number for a node of the element");
  EXPECT_EQ(
      refusal_of_abaqus(replaced(good, "20, 5, 9", "10, 5, 9")),
      "m.inp:20: element 10 is there twice; give every element its own number; an element belongs to one region only");
  EXPECT_EQ(refusal_of_abaqus(good + "*INCLUDE, INPUT=more.inp\n"),
            "m.inp:23: *INCLUDE is not read; put the text of that file here");
  EXPECT_EQ(refusal_of_abaqus(good + "*NGEN\n1, 2\n"), "m.inp:23: *NGEN is not read; write every node out");
  EXPECT_EQ(refusal_of_abaqus(good + "*NSET\n1\n"), "m.inp:23: *NSET has no NSET; write *NSET, NSET=...");
  EXPECT_EQ(refusal_of_abaqus(good + "*NSET, NSET=a\n1, b\n"),
            "m.inp:24: set \"a\" names \"b\", which is neither a number nor a set that stands above");
  EXPECT_EQ(refusal_of_abaqus(good + "*NSET, NSET=a\n99\n"),
            "m.inp:24: node set \"a\" names node 99, which the file does not have");
  EXPECT_EQ(refusal_of_abaqus(good + "*ELSET, ELSET=a\n99\n"),
            "m.inp:24: set \"a\" names element 99, which the file does not have");
  EXPECT_EQ(refusal_of_abaqus(good + "*NSET, NSET=a, GENERATE\n9, 1\n"),
            "m.inp:24: the range from 9 to 1 by 1 is not a range of labels");
  EXPECT_EQ(refusal_of_abaqus(good + "*SURFACE, NAME=a\n99, S1\n"),
            "m.inp:24: surface \"a\" names element 99, which the file does not have");
  EXPECT_EQ(refusal_of_abaqus(good + "*SURFACE, NAME=a\nlid, S1\n"),
            "m.inp:24: surface \"a\" names the set \"lid\", which the file does not have");
  EXPECT_EQ(refusal_of_abaqus(good + "*SURFACE, NAME=a\n10, SPOS\n"),
            "m.inp:24: surface \"a\" names side SPOS of element 10; write S1 to S6");
  EXPECT_EQ(refusal_of_abaqus(good + "*SURFACE, NAME=a\n10\n"),
            "m.inp:24: surface \"a\" names no side of element 10; write S1 to S6");
  EXPECT_EQ(refusal_of_abaqus(good + "*SURFACE, NAME=a, TYPE=CUTTING SURFACE\n"),
            "m.inp:23: *SURFACE of TYPE=CUTTING SURFACE is not read; use TYPE=ELEMENT or TYPE=NODE");
}

}  // namespace
}  // namespace couplet::solid
