#include "solid-server/mesh/file/read_mesh.hpp"

#include "proto/report/failure.hpp"
#include "solid-server/mesh/check_mesh.hpp"
#include "solid-server/mesh/file/abaqus_lines.hpp"
#include "solid-server/mesh/file/mesh_text.hpp"
#include "solid-server/mesh/file/read_abaqus.hpp"
#include "solid-server/mesh/file/read_gmsh.hpp"

namespace couplet::solid {

MeshReading read_mesh(const std::filesystem::path& file, double length_unit) {
  const std::string ending = in_capitals(file.extension().string());
  if (ending != ".MSH" && ending != ".INP")
    throw report::SceneError(file.string(), "meshes with the ending \"" + file.extension().string() + "\" are not read",
                             "give a .msh file of Gmsh or an .inp file of Abaqus or CalculiX");
  const std::string text = read_mesh_text(file);
  MeshReading reading;
  if (ending == ".MSH")
    reading.mesh = read_gmsh(text, file.string(), length_unit);
  else
    reading = read_abaqus(text, file.string(), length_unit);
  check_mesh(reading.mesh, file.string());
  return reading;
}

}  // namespace couplet::solid
