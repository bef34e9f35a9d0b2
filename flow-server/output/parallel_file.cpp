#include "flow-server/output/parallel_file.hpp"

#include <algorithm>
#include <utility>

#include "proto/report/failure.hpp"
#include "proto/store/hdf5_handle.hpp"

namespace couplet::flow {

namespace {

/// Before the first use: no messages of its own, no work after MPI has ended.
void prepare_library() {
  static const bool is_prepared = [] {
    H5dont_atexit();
    return H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
  }();
  (void)is_prepared;
}

bool holds_everywhere(bool holds, MPI_Comm communicator) {
  int everywhere = holds ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &everywhere, 1, MPI_INT, MPI_MIN, communicator);
  return everywhere == 1;
}

int rank_of(MPI_Comm communicator) {
  int rank = 0;
  MPI_Comm_rank(communicator, &rank);
  return rank;
}

hid_t make_dataset(hid_t file, const std::string& name, hid_t type, hid_t space) {
  const store::Hdf5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const store::Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);  // every entry is written anyhow
  return H5Dcreate2(file, name.c_str(), type, space, links, creation, H5P_DEFAULT);
}

bool is_empty(const ArrayBlock& block) {
  return std::find(block.count.begin(), block.count.end(), hsize_t{0}) != block.count.end();
}

/// The rank's part of the file's array, and the same as dense memory; nothing selected for a rank without entries.
void select(const ArrayBlock& block, hid_t file_space, hid_t memory_space) {
  if (is_empty(block)) {
    H5Sselect_none(file_space);
    H5Sselect_none(memory_space);
  } else {
    H5Sselect_hyperslab(file_space, H5S_SELECT_SET, block.start.data(), nullptr, block.count.data(), nullptr);
  }
}

/// One entry stands for a rank without any: the library wants a space to select nothing of.
std::vector<hsize_t> memory_shape(const ArrayBlock& block) {
  return is_empty(block) ? std::vector<hsize_t>{1} : block.count;
}

store::Hdf5Handle collective_transfer() {
  store::Hdf5Handle transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  return store::Hdf5Handle(H5Pcopy(transfer), H5Pclose);
}

}  // namespace

ParallelFile ParallelFile::open(const std::filesystem::path& path, unsigned mode, MPI_Comm communicator) {
  prepare_library();
  const store::Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_mpio(access, communicator, MPI_INFO_NULL);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  H5Pset_coll_metadata_write(access, true);
  H5Pset_all_coll_metadata_ops(access, true);
  const bool is_new = mode == H5F_ACC_TRUNC;
  const hid_t file = is_new ? H5Fcreate(path.c_str(), mode, H5P_DEFAULT, access) : H5Fopen(path.c_str(), mode, access);
  if (!holds_everywhere(file >= 0, communicator)) {
    throw report::FileError(path.string(), is_new ? "cannot make this file" : "cannot read this as an HDF5 file",
                            is_new ? "check the folder and its permissions" : "check the path, or make the file again");
  }
  return ParallelFile(path, file, communicator);
}

ParallelFile ParallelFile::create(const std::filesystem::path& path, MPI_Comm communicator) {
  return open(path, H5F_ACC_TRUNC, communicator);
}

ParallelFile ParallelFile::open_for_reading(const std::filesystem::path& path, MPI_Comm communicator) {
  return open(path, H5F_ACC_RDONLY, communicator);
}

ParallelFile::ParallelFile(ParallelFile&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, hid_t{-1})),
      communicator_(other.communicator_),
      is_broken_(other.is_broken_) {}

ParallelFile::~ParallelFile() {
  if (file_ >= 0 && !is_broken_) H5Fclose(file_);
}

void ParallelFile::agree(bool is_well, const std::string& name, const std::string& sentence) const {
  if (holds_everywhere(is_well, communicator_)) return;
  throw report::FileError(path_.string(), "dataset '" + name + "' " + sentence,
                          "resume with the scene and the version that wrote it");
}

void ParallelFile::break_off_unless(bool is_well, const std::string& name, const std::string& sentence) {
  if (holds_everywhere(is_well, communicator_)) return;
  is_broken_ = true;
  throw report::FileError(path_.string(), name.empty() ? sentence : "dataset '" + name + "' " + sentence,
                          "free some space and resume from the last checkpoint");
}

void ParallelFile::write(const std::string& name, const ArrayBlock& block, const double* values, Precision precision) {
  const int rank = static_cast<int>(block.shape.size());
  const store::Hdf5Handle file_space(H5Screate_simple(rank, block.shape.data(), nullptr), H5Sclose);
  const hid_t type = precision == Precision::single ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
  const store::Hdf5Handle dataset(make_dataset(file_, name, type, file_space), H5Dclose);
  break_off_unless(dataset.is_well(), name, "cannot be made");
  const std::vector<hsize_t> shape = memory_shape(block);
  const store::Hdf5Handle memory_space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                                       H5Sclose);
  select(block, file_space, memory_space);
  const store::Hdf5Handle transfer = collective_transfer();
  const double nothing = 0;
  const herr_t status =
      H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory_space, file_space, transfer, is_empty(block) ? &nothing : values);
  break_off_unless(status >= 0, name, "cannot be written");
}

void ParallelFile::read(const std::string& name, const ArrayBlock& block, double* values) const {
  agree(contains(name), name, "is missing");
  const store::Hdf5Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  const store::Hdf5Handle file_space(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> found(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(file_space))));
  H5Sget_simple_extent_dims(file_space, found.data(), nullptr);
  agree(found == block.shape, name, "has another shape than the grid");
  const std::vector<hsize_t> shape = memory_shape(block);
  const store::Hdf5Handle memory_space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                                       H5Sclose);
  select(block, file_space, memory_space);
  const store::Hdf5Handle transfer = collective_transfer();
  double nothing = 0;
  const herr_t status =
      H5Dread(dataset, H5T_NATIVE_DOUBLE, memory_space, file_space, transfer, is_empty(block) ? &nothing : values);
  agree(status >= 0, name, "cannot be read");
}

bool ParallelFile::contains(const std::string& name) const {
  // Each group on the way is asked for, as the library refuses to look below a missing one.
  for (std::size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
    if (H5Lexists(file_, name.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

void ParallelFile::write_list(const std::string& name, const std::vector<double>& values) {
  const hsize_t n = values.size();
  write(name, {{n}, {0}, {rank_of(communicator_) == 0 ? n : 0}}, values.data(), Precision::full);
}

std::vector<double> ParallelFile::read_list(const std::string& name) const {
  agree(contains(name), name, "is missing");
  hsize_t n = 0;
  {
    const store::Hdf5Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    const store::Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
    n = static_cast<hsize_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  }
  std::vector<double> values(n);
  read(name, {{n}, {0}, {n}}, values.data());
  return values;
}

void ParallelFile::write_text(const std::string& name, const std::string& text) {
  const store::Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(1, text.size()));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const store::Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const store::Hdf5Handle dataset(make_dataset(file_, name, type, space), H5Dclose);
  break_off_unless(dataset.is_well(), name, "cannot be made");
  const bool is_writer = rank_of(communicator_) == 0;
  const herr_t status = is_writer ? H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) : 0;
  break_off_unless(status >= 0, name, "cannot be written");
}

std::string ParallelFile::read_text(const std::string& name) const {
  agree(contains(name), name, "is missing");
  const store::Hdf5Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  const store::Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  agree(H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0, name, "is not a text of fixed length");
  std::string text(H5Tget_size(type), '\0');
  agree(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0, name, "cannot be read");
  text.resize(text.find_last_not_of('\0') + 1);
  return text;
}

void ParallelFile::close() {
  if (file_ < 0) return;
  break_off_unless(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0, "", "cannot be written to the disk");
  const bool is_well = H5Fclose(std::exchange(file_, hid_t{-1})) >= 0;
  break_off_unless(is_well, "", "cannot be closed");
}

}  // namespace couplet::flow
