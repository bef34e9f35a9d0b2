#include "deploy/launcher/version_text.hpp"

#include <google/protobuf/stubs/common.h>
#include <hdf5.h>
#include <zmq.h>

#include <Eigen/Core>

#include "deploy/launcher/external_program.hpp"
#include "proto/report/version.hpp"

namespace couplet::launcher {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string mpi_version() {
  const ProgramResult result = run_and_catch({"mpirun", "--version"});
  return result.exit_code == 0 ? result.output.substr(0, result.output.find('\n')) : "mpirun is missing";
}

}  // namespace

std::string version_text() {
  int zmq_major = 0, zmq_minor = 0, zmq_patch = 0;
  zmq_version(&zmq_major, &zmq_minor, &zmq_patch);
  unsigned hdf5_major = 0, hdf5_minor = 0, hdf5_release = 0;
  H5get_libversion(&hdf5_major, &hdf5_minor, &hdf5_release);
  return "couplet   " + report::version() + "\ncommit    " + report::commit() + "\ncompiler  " + report::compiler() +
         "\nMPI       " + mpi_version() + "\nZeroMQ    " + dotted(zmq_major, zmq_minor, zmq_patch) + "\nHDF5      " +
         dotted(static_cast<int>(hdf5_major), static_cast<int>(hdf5_minor), static_cast<int>(hdf5_release)) +
         "\nprotobuf  " + google::protobuf::internal::VersionString(GOOGLE_PROTOBUF_VERSION) + "\nEigen     " +
         dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION) + "\n";
}

}  // namespace couplet::launcher
