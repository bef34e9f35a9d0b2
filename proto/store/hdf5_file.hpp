#pragma once
// A thin owner of an HDF5 file: whole arrays, single numbers, texts. Every failure is a FileError naming file and
// dataset. The HDF5 library is not made for threads: all calls to it go through here, one at a time.

#include <hdf5.h>

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "proto/surface/surface_mesh.hpp"

namespace couplet::store {

class Hdf5File {
 public:
  static Hdf5File create(const std::filesystem::path& path);            // an existing file is replaced
  static Hdf5File open_for_reading(const std::filesystem::path& path);  // throws FileError when it is not an HDF5 file
  static Hdf5File open_for_appending(const std::filesystem::path& path);
  Hdf5File(Hdf5File&& other) noexcept;
  Hdf5File& operator=(Hdf5File&&) = delete;
  ~Hdf5File();

  const std::filesystem::path& path() const { return path_; }

  /// Whole arrays, (n_rows, n_columns), and lists. Groups in the name ("a/b") are made.
  void write(const std::string& name, const surface::NodeArray& values);
  void write(const std::string& name, const std::vector<std::int64_t>& values, std::int64_t n_columns = 1);
  void write(const std::string& name, const std::vector<double>& values);
  void write_float(const std::string& name, const surface::NodeArray& values);  // stored in single precision
  surface::NodeArray read(const std::string& name) const;
  std::vector<std::int64_t> read_integers(const std::string& name) const;
  bool contains(const std::string& name) const;
  /// Lets `name` stand for all that lies in another file, whose path is relative to the folder of this one. The other
  /// file need not be there yet.
  void link_to_file(const std::string& name, const std::string& other_file);

  /// Makes room for an array that is written later without HDF5, and tells where its first byte will lie in the file:
  /// dense, little-endian, no zeros written. One column makes a vector. The place holds after close().
  std::int64_t reserve_float(const std::string& name, std::int64_t n_rows, std::int64_t n_columns);
  std::int64_t reserve_double(const std::string& name, std::int64_t n_rows);
  std::int64_t reserve_integer(const std::string& name, std::int64_t n_rows);
  /// Where the first byte of a dense dataset lies in the file.
  std::int64_t offset_of(const std::string& name) const;

  void write_number(const std::string& name, double value);
  void write_integer(const std::string& name, std::int64_t value);
  void write_text(const std::string& name, const std::string& text);
  double read_number(const std::string& name) const;
  std::int64_t read_integer(const std::string& name) const;
  std::string read_text(const std::string& name) const;

  /// What was written reaches the file.
  void flush();
  /// Flushes and closes; errors are thrown here and not in the destructor.
  void close();

 private:
  Hdf5File(std::filesystem::path path, hid_t file) : path_(std::move(path)), file_(file) {}
  [[noreturn]] void refuse(const std::string& name, const std::string& sentence) const;
  [[noreturn]] void break_off(const std::string& name, const std::string& sentence);
  hid_t make_dataset(const std::string& name, hid_t type, const std::vector<hsize_t>& shape, bool reserved);
  void write_dataset(const std::string& name, hid_t file_type, hid_t memory_type, const std::vector<hsize_t>& shape,
                     const void* values);
  std::int64_t reserve(const std::string& name, hid_t type, const std::vector<hsize_t>& shape);
  void read_dataset(const std::string& name, hid_t memory_type, hid_t dataset, void* values) const;
  hid_t open_dataset(const std::string& name, H5T_class_t expected, const std::string& what) const;
  std::filesystem::path path_;
  hid_t file_ = -1;
  bool is_broken_ = false;  // a write has failed; the library is not asked to try again, which ends in a crash
};

}  // namespace couplet::store
