#pragma once
// Requests and replies with their arrays, as frames and back.

#include <optional>
#include <string>

#include "couplet/v1/exchange.pb.h"
#include "proto/surface/surface_field.hpp"
#include "proto/surface/surface_mesh.hpp"
#include "proto/wire/channel.hpp"

namespace couplet::wire {

/// The arrays that travel with a message. Four names belong to a surface and cannot be names of fields: node_position,
/// face_offset, face_node, face_region.
struct Arrays {
  surface::FieldSet fields;
  std::optional<surface::SurfaceMesh> surface;  // of OpenScene and SceneReady
};

/// Frames of a message; its `array` list and, with a surface, the names of regions and markers are filled in here.
/// Fields of a request are copied, because the coupler keeps them; those of a reply are handed over.
Frames encode_request(v1::Request request, const surface::FieldSet& fields, const surface::SurfaceMesh* surface);
Frames encode_reply(v1::Reply reply, surface::FieldSet fields, const surface::SurfaceMesh* surface);

/// Frame 0. Throws PeerError when it cannot be read or does not announce as many arrays as there are frames.
v1::Request decode_request(const Frames& message, const std::string& whose);
v1::Reply decode_reply(const Frames& message, const std::string& whose);

/// The other frames. Throws PeerError on a bad array, a name that comes twice, a surface that is not whole.
Arrays decode_arrays(const v1::Request& request, const Frames& message, const std::string& whose);
Arrays decode_arrays(const v1::Reply& reply, const Frames& message, const std::string& whose);

}  // namespace couplet::wire
