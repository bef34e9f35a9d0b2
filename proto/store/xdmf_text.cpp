#include "proto/store/xdmf_text.hpp"

#include <charconv>
#include <iterator>

#include "proto/store/result_layout.hpp"

namespace couplet::store {

namespace {

std::string shortest(double value) {
  char digits[32];
  return {std::begin(digits), std::to_chars(std::begin(digits), std::end(digits), value).ptr};
}

/// The few signs that mean something to XML.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char sign : text) {
    switch (sign) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += sign;
    }
  }
  return result;
}

std::string data_item(const std::string& type, int bytes, const std::string& dimensions, const std::string& place) {
  return "<DataItem NumberType=\"" + type + "\" Precision=\"" + std::to_string(bytes) + "\" Dimensions=\"" +
         dimensions + "\" Format=\"HDF\">" + escaped(place) + "</DataItem>";
}

std::string topology_type(CellShape shape) {
  switch (shape) {
    case CellShape::polyline:
      return "TopologyType=\"Polyline\" NodesPerElement=\"2\"";
    case CellShape::hexahedron20:
      return "TopologyType=\"Hexahedron_20\"";
    case CellShape::hexahedron8:
      return "TopologyType=\"Hexahedron\"";
    case CellShape::tetrahedron10:
      return "TopologyType=\"Tetrahedron_10\"";
    case CellShape::mixed:
      return "TopologyType=\"Mixed\"";
    case CellShape::triangle:
      return "TopologyType=\"Triangle\"";
    case CellShape::quadrilateral:
      return "TopologyType=\"Quadrilateral\"";
  }
  return "";
}

std::string topology(const XdmfMesh& mesh) {
  const std::int64_t n_columns = layout_of(mesh.shape).n_columns;
  return "<Topology " + topology_type(mesh.shape) + " NumberOfElements=\"" + std::to_string(mesh.n_cells) + "\">" +
         data_item("Int", 8, std::to_string(mesh.n_cell_nodes / n_columns) + " " + std::to_string(n_columns),
                   mesh.file + ":/mesh/cell") +
         "</Topology>\n";
}

std::string attribute_type(std::int64_t n_components) {
  return n_components == 1 ? "Scalar" : n_components == 3 ? "Vector" : "Tensor";
}

std::string attribute(const std::string& name, const std::string& type, const std::string& center,
                      const std::string& item) {
  return "<Attribute Name=\"" + escaped(name) + "\" AttributeType=\"" + type + "\" Center=\"" + center + "\">" + item +
         "</Attribute>\n";
}

}  // namespace

std::string xdmf_start(const std::string& name) {
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"" + escaped(name) +
         "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
}

std::string xdmf_state(const XdmfMesh& mesh, const std::vector<XdmfField>& fields, bool is_moving, double time,
                       const std::string& file, std::int64_t slot) {
  const std::string n_nodes = std::to_string(mesh.n_nodes);
  std::string text = "<Grid GridType=\"Uniform\"><Time Value=\"" + shortest(time) + "\"/>\n" + topology(mesh);
  text += "<Geometry GeometryType=\"XYZ\">";
  text += is_moving ? data_item("Float", 4, n_nodes + " 3", file + ":/" + state_dataset(slot, moved_position))
                    : data_item("Float", 8, n_nodes + " 3", mesh.file + ":/mesh/position");
  text += "</Geometry>\n";
  for (const XdmfField& field : fields) {
    const std::string rows = std::to_string(field.is_of_cells ? mesh.n_cells : mesh.n_nodes);
    const std::string columns = field.n_components == 1 ? "" : " " + std::to_string(field.n_components);
    text += attribute(field.name, attribute_type(field.n_components), field.is_of_cells ? "Cell" : "Node",
                      data_item("Float", 4, rows + columns, file + ":/" + state_dataset(slot, field.name)));
  }
  for (const std::string& name : mesh.cell_number)
    text += attribute(name, "Scalar", "Cell",
                      data_item("Int", 8, std::to_string(mesh.n_cells), mesh.file + ":/" + mesh_dataset(name)));
  return text + "</Grid>\n";
}

std::string xdmf_end() {
  return "</Grid>\n</Domain>\n</Xdmf>\n";
}

}  // namespace couplet::store
