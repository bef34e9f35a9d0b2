#pragma once
// An HDF5 file that all ranks of a flow write and read together. Every call is collective, with equal arguments but for
// a rank's own block; a failure on one rank is thrown as FileError on all.

#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace couplet::flow {

/// A rank's part of an array, slowest index first.
struct ArrayBlock {
  std::vector<hsize_t> shape;  // of the whole
  std::vector<hsize_t> start;  // first entry of this rank
  std::vector<hsize_t> count;  // entries of this rank; any 0: none
};

enum class Precision { single, full };

class ParallelFile {
 public:
  static ParallelFile create(const std::filesystem::path& path, MPI_Comm communicator);  // an existing file is replaced
  static ParallelFile open_for_reading(const std::filesystem::path& path, MPI_Comm communicator);
  ParallelFile(ParallelFile&& other) noexcept;
  ParallelFile& operator=(ParallelFile&&) = delete;
  ~ParallelFile();

  const std::filesystem::path& path() const { return path_; }

  /// `values`: the rank's block, dense. Groups in the name are made.
  void write(const std::string& name, const ArrayBlock& block, const double* values, Precision precision);
  void read(const std::string& name, const ArrayBlock& block, double* values) const;
  bool contains(const std::string& name) const;

  /// Equal on all ranks; rank 0 writes them.
  void write_list(const std::string& name, const std::vector<double>& values);
  void write_text(const std::string& name, const std::string& text);
  std::vector<double> read_list(const std::string& name) const;
  std::string read_text(const std::string& name) const;

  /// What was written reaches the disk; errors are thrown here and not in the destructor.
  void close();

 private:
  ParallelFile(std::filesystem::path path, hid_t file, MPI_Comm communicator)
      : path_(std::move(path)), file_(file), communicator_(communicator) {}
  static ParallelFile open(const std::filesystem::path& path, unsigned mode, MPI_Comm communicator);
  /// Throws on all ranks when it does not hold on one of them.
  void agree(bool is_well, const std::string& name, const std::string& sentence) const;
  void break_off_unless(bool is_well, const std::string& name, const std::string& sentence);

  std::filesystem::path path_;
  hid_t file_ = -1;
  MPI_Comm communicator_;
  bool is_broken_ = false;  // a write has failed: the library is not asked to try again
};

}  // namespace couplet::flow
