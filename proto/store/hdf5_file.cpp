#include "proto/store/hdf5_file.hpp"

#include <algorithm>
#include <bit>
#include <mutex>
#include <utility>

#include "proto/report/failure.hpp"
#include "proto/store/hdf5_handle.hpp"

namespace couplet::store {

namespace {

static_assert(std::endian::native == std::endian::little, "reserved arrays are written as the processor holds them");

/// The library keeps its state in the process, so its guard is of the process too.
std::recursive_mutex& hdf5_guard() {
  static std::recursive_mutex guard;
  return guard;
}
using Guard = std::lock_guard<std::recursive_mutex>;

herr_t keep_first(unsigned, const H5E_error2_t* error, void* reason) {
  auto& text = *static_cast<std::string*>(reason);
  if (text.empty() && error->desc != nullptr) text = error->desc;
  return 0;
}

/// What the library says about its last failure, innermost sentence.
std::string reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  // Low-level sentences end in numbers for programmers: "... errno = 28, error message = 'No space left on device', buf
  // = ..."
  const std::string start = "error message = '";
  const auto message = text.find(start);
  if (message == std::string::npos) return text;
  const auto from = message + start.size();
  return text.substr(from, text.find('\'', from) - from);
}

/// Before the first use: no messages of its own, and no work at the end of the process (where it would try once more to
/// write what could not be written, and crash; files that are well have been closed by then).
void prepare_library() {
  static const bool is_prepared = [] {
    H5dont_atexit();
    return H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
  }();
  (void)is_prepared;
}

Hdf5Handle access_properties() {
  Hdf5Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // A result that somebody looks at must not stop the run that writes it; some file systems know no locks.
  H5Pset_file_locking(properties, false, true);
  // Nothing stays open behind a file that was closed.
  H5Pset_fclose_degree(properties, H5F_CLOSE_STRONG);
  return Hdf5Handle(H5Pcopy(properties), H5Pclose);
}

[[noreturn]] void refuse_file(const std::filesystem::path& path, const std::string& sentence,
                              const std::string& advice) {
  const std::string why = reason();
  throw report::FileError(path.string(), sentence + (why.empty() ? "" : ": " + why), advice);
}

std::vector<hsize_t> shape_of(hid_t dataset) {
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  return shape;
}

std::vector<hsize_t> shape_of(const surface::NodeArray& values) {
  return {static_cast<hsize_t>(values.rows()), static_cast<hsize_t>(values.cols())};
}

}  // namespace

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  const Guard guard(hdf5_guard());
  prepare_library();
  const Hdf5Handle access = access_properties();
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (file < 0) refuse_file(path, "cannot make this file", "check the folder and its permissions");
  return Hdf5File(path, file);
}

Hdf5File Hdf5File::open_for_reading(const std::filesystem::path& path) {
  const Guard guard(hdf5_guard());
  prepare_library();
  const Hdf5Handle access = access_properties();
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
  if (file < 0) refuse_file(path, "cannot read this as an HDF5 file", "check the path, or make the file again");
  return Hdf5File(path, file);
}

Hdf5File Hdf5File::open_for_appending(const std::filesystem::path& path) {
  const Guard guard(hdf5_guard());
  prepare_library();
  const Hdf5Handle access = access_properties();
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
  if (file < 0) refuse_file(path, "cannot write to this as an HDF5 file", "check the path and its permissions");
  return Hdf5File(path, file);
}

Hdf5File::Hdf5File(Hdf5File&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, hid_t{-1})), is_broken_(other.is_broken_) {}

Hdf5File::~Hdf5File() {
  const Guard guard(hdf5_guard());
  if (file_ >= 0 && !is_broken_) H5Fclose(file_);
}

void Hdf5File::refuse(const std::string& name, const std::string& sentence) const {
  refuse_file(path_, "dataset '" + name + "': " + sentence, "");
}

void Hdf5File::break_off(const std::string& name, const std::string& sentence) {
  is_broken_ = true;
  refuse_file(path_, (name.empty() ? "" : "dataset '" + name + "': ") + sentence,
              "free some space and resume from the last checkpoint");
}

hid_t Hdf5File::make_dataset(const std::string& name, hid_t type, const std::vector<hsize_t>& shape, bool reserved) {
  if (contains(name) && H5Ldelete(file_, name.c_str(), H5P_DEFAULT) < 0) break_off(name, "cannot be replaced");
  const Hdf5Handle space(
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
      H5Sclose);
  const Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (reserved) {
    H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
    H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
  }
  const hid_t dataset = H5Dcreate2(file_, name.c_str(), type, space, links, creation, H5P_DEFAULT);
  if (dataset < 0) break_off(name, "cannot be made");
  return dataset;
}

void Hdf5File::write_dataset(const std::string& name, hid_t file_type, hid_t memory_type,
                             const std::vector<hsize_t>& shape, const void* values) {
  const Guard guard(hdf5_guard());
  Hdf5Handle dataset(make_dataset(name, file_type, shape, false), H5Dclose);
  const bool is_empty = std::find(shape.begin(), shape.end(), hsize_t{0}) != shape.end();
  if (!is_empty && H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    break_off(name, "cannot be written");
  if (!dataset.close()) break_off(name, "cannot be written");
}

std::int64_t Hdf5File::reserve(const std::string& name, hid_t type, const std::vector<hsize_t>& shape) {
  const Guard guard(hdf5_guard());
  const Hdf5Handle dataset(make_dataset(name, type, shape, true), H5Dclose);
  return offset_of(name);
}

std::int64_t Hdf5File::offset_of(const std::string& name) const {
  const Guard guard(hdf5_guard());
  const Hdf5Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  const haddr_t offset = dataset < 0 ? HADDR_UNDEF : H5Dget_offset(dataset);
  if (offset == HADDR_UNDEF) refuse(name, "has no place in the file");
  return static_cast<std::int64_t>(offset);
}

std::int64_t Hdf5File::reserve_float(const std::string& name, std::int64_t n_rows, std::int64_t n_columns) {
  std::vector<hsize_t> shape{static_cast<hsize_t>(n_rows)};
  if (n_columns != 1) shape.push_back(static_cast<hsize_t>(n_columns));
  return reserve(name, H5T_IEEE_F32LE, shape);
}

std::int64_t Hdf5File::reserve_double(const std::string& name, std::int64_t n_rows) {
  return reserve(name, H5T_IEEE_F64LE, {static_cast<hsize_t>(n_rows)});
}

std::int64_t Hdf5File::reserve_integer(const std::string& name, std::int64_t n_rows) {
  return reserve(name, H5T_STD_I64LE, {static_cast<hsize_t>(n_rows)});
}

void Hdf5File::write(const std::string& name, const surface::NodeArray& values) {
  write_dataset(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, shape_of(values), values.data());
}

void Hdf5File::write(const std::string& name, const std::vector<std::int64_t>& values, std::int64_t n_columns) {
  std::vector<hsize_t> shape{static_cast<hsize_t>(values.size()) / static_cast<hsize_t>(n_columns)};
  if (n_columns > 1) shape.push_back(static_cast<hsize_t>(n_columns));
  write_dataset(name, H5T_STD_I64LE, H5T_NATIVE_INT64, shape, values.data());
}

void Hdf5File::write(const std::string& name, const std::vector<double>& values) {
  write_dataset(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {values.size()}, values.data());
}

void Hdf5File::write_float(const std::string& name, const surface::NodeArray& values) {
  write_dataset(name, H5T_IEEE_F32LE, H5T_NATIVE_DOUBLE, shape_of(values), values.data());
}

void Hdf5File::write_number(const std::string& name, double value) {
  write_dataset(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, {}, &value);
}

void Hdf5File::write_integer(const std::string& name, std::int64_t value) {
  write_dataset(name, H5T_STD_I64LE, H5T_NATIVE_INT64, {}, &value);
}

void Hdf5File::write_text(const std::string& name, const std::string& text) {
  const Guard guard(hdf5_guard());
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(1, text.size()));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  write_dataset(name, type, type, {}, text.c_str());
}

bool Hdf5File::contains(const std::string& name) const {
  const Guard guard(hdf5_guard());
  // Each group on the way is asked for, as the library refuses to look below a missing one.
  for (std::size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
    const std::string part = name.substr(0, end);
    if (H5Lexists(file_, part.c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

void Hdf5File::link_to_file(const std::string& name, const std::string& other_file) {
  const Guard guard(hdf5_guard());
  const Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  if (H5Lcreate_external(other_file.c_str(), "/", file_, name.c_str(), links, H5P_DEFAULT) < 0)
    break_off(name, "cannot be made");
}

hid_t Hdf5File::open_dataset(const std::string& name, H5T_class_t expected, const std::string& what) const {
  if (!contains(name)) throw report::FileError(path_.string(), "dataset '" + name + "' is missing");
  const hid_t dataset = H5Dopen2(file_, name.c_str(), H5P_DEFAULT);
  if (dataset < 0) refuse(name, "cannot be opened");
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  if (H5Tget_class(type) == expected) return dataset;
  H5Dclose(dataset);
  throw report::FileError(path_.string(), "dataset '" + name + "' does not hold " + what);
}

void Hdf5File::read_dataset(const std::string& name, hid_t memory_type, hid_t dataset, void* values) const {
  if (H5Dread(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) refuse(name, "cannot be read");
}

surface::NodeArray Hdf5File::read(const std::string& name) const {
  const Guard guard(hdf5_guard());
  const Hdf5Handle dataset(open_dataset(name, H5T_FLOAT, "real numbers"), H5Dclose);
  const auto shape = shape_of(dataset);
  if (shape.empty() || shape.size() > 2)
    throw report::FileError(path_.string(), "dataset '" + name + "' is not an array of rows and columns");
  surface::NodeArray values(shape[0], shape.size() == 2 ? shape[1] : 1);
  if (values.size() > 0) read_dataset(name, H5T_NATIVE_DOUBLE, dataset, values.data());
  return values;
}

std::vector<std::int64_t> Hdf5File::read_integers(const std::string& name) const {
  const Guard guard(hdf5_guard());
  const Hdf5Handle dataset(open_dataset(name, H5T_INTEGER, "whole numbers"), H5Dclose);
  hsize_t count = 1;
  for (const hsize_t extent : shape_of(dataset)) count *= extent;
  std::vector<std::int64_t> values(count);
  if (count > 0) read_dataset(name, H5T_NATIVE_INT64, dataset, values.data());
  return values;
}

double Hdf5File::read_number(const std::string& name) const {
  const Guard guard(hdf5_guard());
  const Hdf5Handle dataset(open_dataset(name, H5T_FLOAT, "a real number"), H5Dclose);
  if (!shape_of(dataset).empty()) throw report::FileError(path_.string(), "dataset '" + name + "' is an array");
  double value = 0;
  read_dataset(name, H5T_NATIVE_DOUBLE, dataset, &value);
  return value;
}

std::int64_t Hdf5File::read_integer(const std::string& name) const {
  const Guard guard(hdf5_guard());
  const Hdf5Handle dataset(open_dataset(name, H5T_INTEGER, "a whole number"), H5Dclose);
  if (!shape_of(dataset).empty()) throw report::FileError(path_.string(), "dataset '" + name + "' is an array");
  std::int64_t value = 0;
  read_dataset(name, H5T_NATIVE_INT64, dataset, &value);
  return value;
}

std::string Hdf5File::read_text(const std::string& name) const {
  const Guard guard(hdf5_guard());
  const Hdf5Handle dataset(open_dataset(name, H5T_STRING, "text"), H5Dclose);
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  if (H5Tis_variable_str(type) > 0 || !shape_of(dataset).empty())
    throw report::FileError(path_.string(), "dataset '" + name + "' is not one text of fixed length");
  std::string text(H5Tget_size(type), '\0');
  read_dataset(name, type, dataset, text.data());
  text.resize(text.find_last_not_of('\0') + 1);
  return text;
}

void Hdf5File::flush() {
  const Guard guard(hdf5_guard());
  if (is_broken_ || H5Fflush(file_, H5F_SCOPE_GLOBAL) < 0) break_off("", "cannot be written to the disk");
}

void Hdf5File::close() {
  if (file_ < 0) return;
  flush();
  const Guard guard(hdf5_guard());
  if (H5Fclose(file_) < 0) break_off("", "cannot be closed");
  file_ = -1;
}

}  // namespace couplet::store
