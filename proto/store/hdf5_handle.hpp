#pragma once
// An open object of an HDF5 file.

#include <hdf5.h>

#include <utility>

namespace couplet::store {

/// Closes an HDF5 object at the end of its scope.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*closer)(hid_t)) : id_(id), closer_(closer) {}
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  ~Hdf5Handle() {
    if (id_ >= 0) closer_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT: stands for the id in every call
  bool is_well() const { return id_ >= 0; }
  /// For objects whose last bytes are written now: false when they were not.
  bool close() { return closer_(std::exchange(id_, hid_t{-1})) >= 0; }

 private:
  hid_t id_;
  herr_t (*closer_)(hid_t);
};

}  // namespace couplet::store
