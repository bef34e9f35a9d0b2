#pragma once
// An array as it travels: one frame of little-endian, dense, row-major numbers and a header that says what they are.

#include <string>

#include "couplet/v1/exchange.pb.h"
#include "proto/surface/surface_mesh.hpp"
#include "proto/wire/frame.hpp"

namespace couplet::wire {

struct PackedArray {
  v1::ArrayHeader header;
  Frame frame;
};

/// (n_nodes, n_components) as FLOAT64. The first copies, the second lets the frame own the array.
PackedArray pack_array(const std::string& name, const std::string& unit, const surface::NodeArray& values);
PackedArray pack_array(const std::string& name, const std::string& unit, surface::NodeArray&& values);

/// (n) as INT64.
PackedArray pack_array(const std::string& name, const surface::IndexArray& values);

/// The array of a frame. Throws PeerError that names the array when scalar type, number of dimensions, number of bytes
/// or checksum are not what the header promises. `whose` names the sender for people.
surface::NodeArray unpack_node_array(const v1::ArrayHeader& header, const Frame& frame, const std::string& whose);
surface::IndexArray unpack_index_array(const v1::ArrayHeader& header, const Frame& frame, const std::string& whose);

}  // namespace couplet::wire
