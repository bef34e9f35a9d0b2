#include "proto/wire/message.hpp"

#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <set>
#include <utility>

#include "proto/report/failure.hpp"
#include "proto/wire/array_frame.hpp"

namespace couplet::wire {

namespace {

using Headers = google::protobuf::RepeatedPtrField<v1::ArrayHeader>;

void append(PackedArray packed, Headers* headers, Frames* frames) {
  headers->Add(std::move(packed.header));
  frames->push_back(std::move(packed.frame));
}

void append(const surface::SurfaceMesh& mesh, Headers* headers, Frames* frames) {
  append(pack_array("node_position", "m", mesh.node_position), headers, frames);
  append(pack_array("face_offset", mesh.face_offset), headers, frames);
  append(pack_array("face_node", mesh.face_node), headers, frames);
  append(pack_array("face_region", mesh.face_region), headers, frames);
}

void write_names(const surface::SurfaceMesh& mesh, v1::SurfaceNames* names) {
  for (const std::string& region : mesh.region) names->add_region(region);
  for (const auto& [name, node] : mesh.marker) {
    auto* marker = names->add_marker();
    marker->set_name(name);
    marker->set_node(node);
  }
}

// Names are printed, become columns of tables and keys of files.
bool is_name(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
}

void read_names(const v1::SurfaceNames& names, surface::SurfaceMesh* mesh, const std::string& whose) {
  const auto check = [&](const std::string& name) {
    if (!is_name(name))
      throw report::PeerError(whose, "a region or marker has no printable name", "use letters, digits, - and _");
  };
  std::for_each(names.region().begin(), names.region().end(), check);
  for (const auto& marker : names.marker()) check(marker.name());
  mesh->region.assign(names.region().begin(), names.region().end());
  for (const auto& marker : names.marker()) mesh->marker[marker.name()] = marker.node();
}

template <class Header>
Frame header_frame(const Header& header) {
  Frame frame(header.ByteSizeLong());
  header.SerializeToArray(frame.data(), static_cast<int>(frame.size()));
  return frame;
}

template <class Header>
Header decode_header(const Frames& message, const std::string& whose, const char* kind) {
  const std::string advice = "check that this address belongs to a program of Couplet, of the same version";
  const google::protobuf::LogSilencer quiet;  // what is wrong is said once, below
  Header header;
  if (message.empty() || message.front().size() > frame_size_limit ||
      !header.ParseFromArray(message.front().data(), static_cast<int>(message.front().size())))
    throw report::PeerError(whose, std::string("a message is not a ") + kind, advice);
  if (header.body_case() == Header::BODY_NOT_SET)
    throw report::PeerError(whose, std::string("a ") + kind + " says nothing that is known here", advice);
  if (static_cast<std::size_t>(header.array_size()) != message.size() - 1) {
    throw report::PeerError(whose,
                            std::string("a ") + kind + " announces " + std::to_string(header.array_size()) +
                                " arrays and brings " + std::to_string(message.size() - 1),
                            advice);
  }
  return header;
}

Arrays decode(const Headers& headers, const v1::SurfaceNames* names, const Frames& message, const std::string& whose) {
  const auto refuse = [&](const std::string& sentence) {
    throw report::PeerError(whose, sentence, "mend the program that sends it (proto/README.md, \"Arrays\")");
  };
  Arrays arrays;
  surface::SurfaceMesh mesh;
  std::set<std::string> seen;
  for (int i = 0; i < headers.size(); ++i) {
    const v1::ArrayHeader& header = headers[i];
    const Frame& frame = message[static_cast<std::size_t>(i) + 1];
    const std::string& name = header.name();
    if (!is_name(name)) refuse("array " + std::to_string(i + 1) + " has no printable name");
    if (!seen.insert(name).second) refuse("array '" + name + "' comes twice");
    if (name == "node_position") {
      mesh.node_position = unpack_node_array(header, frame, whose);
    } else if (name == "face_offset") {
      mesh.face_offset = unpack_index_array(header, frame, whose);
    } else if (name == "face_node") {
      mesh.face_node = unpack_index_array(header, frame, whose);
    } else if (name == "face_region") {
      mesh.face_region = unpack_index_array(header, frame, whose);
    } else {
      arrays.fields.push_back({name, header.unit(), unpack_node_array(header, frame, whose)});
    }
  }
  const std::size_t n_surface_arrays = seen.size() - arrays.fields.size();
  if (n_surface_arrays == 0) return arrays;
  if (names == nullptr) refuse("a surface comes with a message that has none");
  if (seen.count("node_position") == 0) refuse("a surface comes without node_position");
  read_names(*names, &mesh, whose);
  arrays.surface = std::move(mesh);
  return arrays;
}

}  // namespace

Frames encode_request(v1::Request request, const surface::FieldSet& fields, const surface::SurfaceMesh* surface) {
  Frames frames(1);
  if (surface != nullptr) {
    write_names(*surface, request.mutable_open_scene()->mutable_surface());
    append(*surface, request.mutable_array(), &frames);
  }
  for (const auto& field : fields)
    append(pack_array(field.name, field.unit, field.values), request.mutable_array(), &frames);
  frames.front() = header_frame(request);
  return frames;
}

Frames encode_reply(v1::Reply reply, surface::FieldSet fields, const surface::SurfaceMesh* surface) {
  Frames frames(1);
  if (surface != nullptr) {
    write_names(*surface, reply.mutable_scene_ready()->mutable_surface());
    append(*surface, reply.mutable_array(), &frames);
  }
  for (auto& field : fields)
    append(pack_array(field.name, field.unit, std::move(field.values)), reply.mutable_array(), &frames);
  frames.front() = header_frame(reply);
  return frames;
}

v1::Request decode_request(const Frames& message, const std::string& whose) {
  return decode_header<v1::Request>(message, whose, "request");
}

v1::Reply decode_reply(const Frames& message, const std::string& whose) {
  return decode_header<v1::Reply>(message, whose, "reply");
}

Arrays decode_arrays(const v1::Request& request, const Frames& message, const std::string& whose) {
  return decode(request.array(), request.has_open_scene() ? &request.open_scene().surface() : nullptr, message, whose);
}

Arrays decode_arrays(const v1::Reply& reply, const Frames& message, const std::string& whose) {
  return decode(reply.array(), reply.has_scene_ready() ? &reply.scene_ready().surface() : nullptr, message, whose);
}

}  // namespace couplet::wire
