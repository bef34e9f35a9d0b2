#include "flow-server/output/state_catalogue.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>
#include <system_error>

#include "proto/report/failure.hpp"
#include "proto/store/hdf5_file.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::flow {

namespace {

const std::string file_name = "flow.h5";
constexpr std::size_t catalogue_lag = 256;  // states for each of which the files may lag behind by one

/// Six digits or more.
std::string digits(std::int64_t number) {
  const std::string text = std::to_string(number);
  return std::string(text.size() < 6 ? 6 - text.size() : 0, '0') + text;
}

/// The number of the state that a file holds, from its name; none for other files.
std::optional<std::int64_t> number_of(const std::string& name) {
  const std::string start = "flow.", end = ".h5";
  if (name.size() <= start.size() + end.size()) return std::nullopt;
  std::int64_t number = 0;
  std::from_chars(name.data() + start.size(), name.data() + name.size(), number);
  return number >= 0 && name == state_file_name(number) ? std::optional(number) : std::nullopt;
}

/// Numbers of the states whose files are in a folder, in rising order.
std::vector<std::int64_t> stored_numbers(const std::filesystem::path& folder) {
  std::vector<std::int64_t> numbers;
  std::error_code error;  // a folder that is not there holds none
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (const auto number = number_of(entry.path().filename().string())) numbers.push_back(*number);
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

std::string faces_name(const FieldRegion& region, int d) {
  return "grid/" + region.name + "/" + std::string(1, "xyz"[d]);
}

std::vector<std::int64_t> flat(const std::vector<std::array<int, 3>>& triangles) {
  std::vector<std::int64_t> corners;
  for (const auto& triangle : triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

std::string shortest(double value) {
  char text[32];
  return {std::begin(text), std::to_chars(std::begin(text), std::end(text), value).ptr};
}

std::string triangle_name(const StoredSurface& surface) {
  return "body/" + surface.name + "/triangle";
}

std::string data_item(int bytes, const std::string& dimensions, const std::string& place,
                      const std::string& type = "Float") {
  return "<DataItem NumberType=\"" + type + "\" Precision=\"" + std::to_string(bytes) + "\" Dimensions=\"" +
         dimensions + "\" Format=\"HDF\">" + place + "</DataItem>";
}

/// XDMF 3, arrays slowest index first. Names of regions and fields hold nothing that means something to XML.
std::string xdmf_start(const std::string& name) {
  return "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"" + name +
         "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
}

std::string xdmf_state(const FieldRegion& region, double time, const std::string& state_file) {
  std::array<std::string, 3> n_cells, n_faces;
  for (int d = 0; d < 3; ++d) {
    n_cells[d] = std::to_string(n_picture_cells(region, d));
    n_faces[d] = std::to_string(n_picture_cells(region, d) + 1);
  }
  std::string text =
      "<Grid Name=\"" + region.name + "\" GridType=\"Uniform\"><Time Value=\"" + shortest(time) + "\"/>\n";
  text += "<Topology TopologyType=\"3DRectMesh\" Dimensions=\"" + n_faces[2] + " " + n_faces[1] + " " + n_faces[0] +
          "\"/>\n<Geometry GeometryType=\"VXVYVZ\">";
  for (int d = 0; d < 3; ++d) text += data_item(8, n_faces[d], file_name + ":/" + faces_name(region, d));
  text += "</Geometry>\n";
  const std::string cells = n_cells[2] + " " + n_cells[1] + " " + n_cells[0];
  const int bytes = region.precision == Precision::single ? 4 : 8;
  for (const FieldQuantity quantity : region.quantities) {
    const std::string name = name_of(quantity);
    text += "<Attribute Name=\"" + name + "\" AttributeType=\"" + (is_vector(quantity) ? "Vector" : "Scalar") +
            "\" Center=\"Cell\">" +
            data_item(bytes, cells + (is_vector(quantity) ? " 3" : ""), state_file + ":/" + region.name + "/" + name) +
            "</Attribute>\n";
  }
  return text + "</Grid>\n";
}

std::string xdmf_state(const StoredSurface& surface, double time, const std::string& state_file) {
  const std::string n_triangles = std::to_string(surface.triangle.size());
  std::string text =
      "<Grid Name=\"" + surface.name + "\" GridType=\"Uniform\"><Time Value=\"" + shortest(time) + "\"/>\n";
  text += "<Topology TopologyType=\"Triangle\" NumberOfElements=\"" + n_triangles + "\">" +
          data_item(8, n_triangles + " 3", file_name + ":/" + triangle_name(surface), "Int") + "</Topology>\n";
  for (const SurfaceField& field : fields_of(surface)) {
    const bool is_vector = field.n_components == 3;
    const std::string item = data_item(4, std::to_string(surface.n_corners) + (is_vector ? " 3" : ""),
                                       state_file + ":/body/" + surface.name + "/" + field.name);
    text += field.name == "position"
                ? "<Geometry GeometryType=\"XYZ\">" + item + "</Geometry>\n"
                : "<Attribute Name=\"" + field.name + "\" AttributeType=\"" + (is_vector ? "Vector" : "Scalar") +
                      "\" Center=\"Node\">" + item + "</Attribute>\n";
  }
  return text + "</Grid>\n";
}

const std::string xdmf_end = "</Grid>\n</Domain>\n</Xdmf>\n";

}  // namespace

std::string state_file_name(std::int64_t number) {
  return "flow." + digits(number) + ".h5";
}

StateCatalogue::StateCatalogue(const std::filesystem::path& results_folder, const StretchedGrid& grid,
                               std::vector<FieldRegion> regions, std::vector<StoredSurface> surfaces, double time)
    : folder_(results_folder),
      regions_(std::move(regions)),
      surfaces_(std::move(surfaces)),
      listed_(regions_.size() + surfaces_.size()) {
  for (const FieldRegion& region : regions_)
    faces_.push_back({picture_faces(region, grid, 0), picture_faces(region, grid, 1), picture_faces(region, grid, 2)});
  remove_unfinished();
  if (time > 0 && std::filesystem::exists(folder_ / file_name)) {
    keep_states_up_to(time);
  } else {
    std::error_code error;  // what stays is replaced in a moment
    for (const std::string& name : names()) std::filesystem::remove(folder_ / (name + ".xmf"), error);
  }
  write();
  remove_states_not_kept();
}

StateCatalogue::~StateCatalogue() {
  if (n_named_ == states_.size()) return;
  try {
    write();
  } catch (const report::FileError&) {
    // The last states are not named, as after a kill; nobody above can do more about it.
  }
}

/// Of the .xmf files.
std::vector<std::string> StateCatalogue::names() const {
  std::vector<std::string> names;
  for (const FieldRegion& region : regions_) names.push_back(region.name);
  for (const StoredSurface& surface : surfaces_) names.push_back("body." + surface.name);
  return names;
}

void StateCatalogue::remove_unfinished() const {
  const std::vector<std::string> known = names();
  std::vector<std::filesystem::path> left;
  std::error_code error;  // what stays is replaced when its turn comes
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    const std::filesystem::path own_name = entry.path().stem();
    if (entry.path().filename() != store::unfinished(own_name)) continue;
    if (own_name == file_name || number_of(own_name.string()) ||
        std::any_of(known.begin(), known.end(), [&](const std::string& name) { return own_name == name + ".xmf"; }))
      left.push_back(entry.path());
  }
  for (const auto& path : left) std::filesystem::remove(path, error);
}

void StateCatalogue::refuse_another_grid() const {
  const store::Hdf5File file = store::Hdf5File::open_for_reading(folder_ / file_name);
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    for (int d = 0; d < 3; ++d) {
      const std::string name = faces_name(regions_[r], d);
      if (file.contains(name)) {
        const surface::NodeArray found = file.read(name);
        if (std::equal(found.data(), found.data() + found.size(), faces_[r][d].begin(), faces_[r][d].end())) continue;
      }
      throw report::FileError(file.path().string(), "holds other regions or another grid",
                              "resume into another run folder, or remove these results");
    }
  }
}

void StateCatalogue::refuse_other_bodies() const {
  const store::Hdf5File file = store::Hdf5File::open_for_reading(folder_ / file_name);
  for (const StoredSurface& surface : surfaces_) {
    if (file.contains(triangle_name(surface)) && file.read_integers(triangle_name(surface)) == flat(surface.triangle))
      continue;
    throw report::FileError(file.path().string(), "holds no body '" + surface.name + "', or one of other triangles",
                            "resume into another run folder, or remove these results");
  }
}

void StateCatalogue::keep_states_up_to(double time) {
  refuse_another_grid();
  refuse_other_bodies();
  for (const std::int64_t number : stored_numbers(folder_)) {
    const store::Hdf5File file = store::Hdf5File::open_for_reading(folder_ / state_file_name(number));
    const double state_time = file.read("time")(0, 0);
    if (state_time <= time) list({number, state_time});
  }
}

void StateCatalogue::remove_states_not_kept() const {
  for (const std::int64_t number : stored_numbers(folder_)) {
    if (std::any_of(states_.begin(), states_.end(), [&](const State& state) { return state.number == number; }))
      continue;
    std::error_code error;  // a file that stays is replaced when its number comes
    std::filesystem::remove(folder_ / state_file_name(number), error);
  }
}

void StateCatalogue::list(const State& state) {
  states_.push_back(state);
  for (std::size_t r = 0; r < regions_.size(); ++r)
    listed_[r] += xdmf_state(regions_[r], state.time, state_file_name(state.number));
  for (std::size_t s = 0; s < surfaces_.size(); ++s)
    listed_[regions_.size() + s] += xdmf_state(surfaces_[s], state.time, state_file_name(state.number));
}

void StateCatalogue::add(double time) {
  list({next_number(), time});
  if (states_.size() - n_named_ > states_.size() / catalogue_lag) write();
}

void StateCatalogue::write() {
  const std::filesystem::path path = folder_ / file_name;
  store::Hdf5File file = store::Hdf5File::create(store::unfinished(path));
  for (std::size_t r = 0; r < regions_.size(); ++r)
    for (int d = 0; d < 3; ++d) file.write(faces_name(regions_[r], d), faces_[r][d]);
  for (const StoredSurface& surface : surfaces_) file.write(triangle_name(surface), flat(surface.triangle), 3);
  for (const State& state : states_) file.link_to_file("state/" + digits(state.number), state_file_name(state.number));
  file.close();
  store::put_in_place(path);
  const std::vector<std::string> known = names();
  for (std::size_t n = 0; n < known.size(); ++n)
    store::write_file(folder_ / (known[n] + ".xmf"), xdmf_start(known[n]) + listed_[n] + xdmf_end);
  n_named_ = states_.size();
}

}  // namespace couplet::flow
