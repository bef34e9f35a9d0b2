#include "proto/wire/message.hpp"

#include <gtest/gtest.h>

#include <random>

#include "proto/report/failure.hpp"
#include "proto/wire/array_frame.hpp"

namespace couplet::wire {

namespace {

surface::SurfaceMesh two_triangles() {
  surface::SurfaceMesh mesh;
  mesh.node_position = surface::NodeArray::Random(4, 3);
  mesh.face_offset.resize(3);
  mesh.face_offset << 0, 3, 6;
  mesh.face_node.resize(6);
  mesh.face_node << 0, 1, 2, 0, 2, 3;
  mesh.face_region.resize(2);
  mesh.face_region << 1, 0;
  mesh.region = {"lower", "upper"};
  mesh.marker = {{"tip", 2}, {"root", 0}};
  return mesh;
}

surface::FieldSet motion() {
  return {{"displacement", "m", surface::NodeArray::Random(4, 3)},
          {"velocity", "m/s", surface::NodeArray::Random(4, 3)}};
}

v1::Request solve_request() {
  v1::Request request;
  request.set_sequence(7);
  request.mutable_solve_step()->set_step(3);
  return request;
}

std::string complaint(const Frames& message) {
  try {
    decode_arrays(decode_request(message, "coupler"), message, "coupler");
  } catch (const report::PeerError& fault) {
    return fault.what();
  }
  return "";
}

// The same message with another header.
Frames with_header(const Frames& message, const v1::Request& header) {
  Frames changed = share(message);
  changed[0] = Frame::copy_of(header.SerializeAsString());
  return changed;
}

TEST(Message, ARequestComesBackWithItsFields) {
  const auto fields = motion();
  const Frames message = encode_request(solve_request(), fields, nullptr);
  ASSERT_EQ(message.size(), 3U);
  const v1::Request back = decode_request(message, "coupler");
  EXPECT_EQ(back.sequence(), 7U);
  EXPECT_EQ(back.solve_step().step(), 3);
  const Arrays arrays = decode_arrays(back, message, "coupler");
  EXPECT_FALSE(arrays.surface.has_value());
  ASSERT_EQ(arrays.fields.size(), 2U);
  EXPECT_EQ(arrays.fields[1].name, "velocity");
  EXPECT_EQ(arrays.fields[1].unit, "m/s");
  EXPECT_EQ(arrays.fields[1].values, fields[1].values);
}

TEST(Message, AReplyComesBackWithItsSurface) {
  const auto mesh = two_triangles();
  v1::Reply reply;
  reply.mutable_scene_ready()->set_time(0.5);
  const Frames message = encode_reply(std::move(reply), motion(), &mesh);
  const v1::Reply back = decode_reply(message, "solid");
  const Arrays arrays = decode_arrays(back, message, "solid");
  ASSERT_TRUE(arrays.surface.has_value());
  EXPECT_EQ(arrays.surface->node_position, mesh.node_position);
  EXPECT_EQ(arrays.surface->face_offset, mesh.face_offset);
  EXPECT_EQ(arrays.surface->face_node, mesh.face_node);
  EXPECT_EQ(arrays.surface->face_region, mesh.face_region);
  EXPECT_EQ(arrays.surface->region, mesh.region);
  EXPECT_EQ(arrays.surface->marker, mesh.marker);
  EXPECT_EQ(arrays.fields.size(), 2U);
}

TEST(Message, ASurfaceMayHaveNodesOnly) {
  surface::SurfaceMesh mesh;
  mesh.node_position = surface::NodeArray::Random(2, 3);
  const Frames message = encode_reply({}, {}, &mesh);
  const v1::Reply back = decode_reply(message, "solid");
  EXPECT_EQ(decode_arrays(back, message, "solid").surface->n_nodes(), 2);
}

TEST(Message, RubbishIsRefusedInOneSentence) {
  EXPECT_NE(complaint({}).find("coupler: a message is not a request"), std::string::npos);
  Frames rubbish;
  rubbish.push_back(Frame::copy_of("GET / HTTP/1.1"));
  EXPECT_NE(complaint(rubbish), "");
  rubbish[0] = Frame();
  EXPECT_NE(complaint(rubbish).find("says nothing that is known here"), std::string::npos);
}

TEST(Message, AnnouncedAndBroughtArraysMustAgree) {
  Frames message = encode_request(solve_request(), motion(), nullptr);
  message.pop_back();
  EXPECT_NE(complaint(message).find("announces 2 arrays and brings 1"), std::string::npos);
}

TEST(Message, ArraysNeedNamesOfTheirOwn) {
  const Frames message = encode_request(solve_request(), motion(), nullptr);
  v1::Request header = decode_request(message, "coupler");
  header.mutable_array(1)->set_name("displacement");
  EXPECT_NE(complaint(with_header(message, header)).find("array 'displacement' comes twice"), std::string::npos);
  header.mutable_array(1)->clear_name();
  EXPECT_NE(complaint(with_header(message, header)).find("array 2 has no printable name"), std::string::npos);
}

TEST(Message, ASurfaceBelongsToOpenSceneAndMustBeWhole) {
  const Frames message = encode_request(solve_request(), motion(), nullptr);
  v1::Request header = decode_request(message, "coupler");
  header.mutable_array(0)->set_name("node_position");
  EXPECT_NE(complaint(with_header(message, header)).find("a surface comes with a message that has none"),
            std::string::npos);

  const auto mesh = two_triangles();
  Frames opening = encode_request({}, {}, &mesh);
  header = decode_request(opening, "coupler");
  header.mutable_array()->DeleteSubrange(0, 1);
  opening.erase(opening.begin() + 1);
  EXPECT_NE(complaint(with_header(opening, header)).find("a surface comes without node_position"), std::string::npos);
}

TEST(Message, ADamagedArrayIsNamed) {
  Frames message = encode_request(solve_request(), motion(), nullptr);
  message[2].data()[5] ^= std::byte{1};
  EXPECT_NE(complaint(message).find("array 'velocity' was damaged"), std::string::npos);
}

// A few bytes of a message are overwritten, a frame is cut or left out: it is refused by a PeerError or still makes
// sense, and nothing else ever happens (under the sanitizers: nothing at all).
TEST(Message, AnyDamageIsRefusedOrHarmless) {
  const auto mesh = two_triangles();
  const Frames whole = encode_request({}, motion(), &mesh);
  std::mt19937 random(11);
  int n_refused = 0;
  for (int i = 0; i < 3000; ++i) {
    Frames message;
    for (const Frame& frame : whole) message.push_back(frame.copy());
    Frame& frame = message[random() % 2 == 0 ? 0 : random() % message.size()];
    for (std::size_t k = 0; k < 1 + random() % 3; ++k)
      frame.data()[random() % frame.size()] = static_cast<std::byte>(random());
    if (random() % 8 == 0) frame = Frame::copy_of(frame.data(), random() % frame.size());
    if (random() % 16 == 0) message.erase(message.begin() + static_cast<std::ptrdiff_t>(random() % message.size()));
    n_refused += complaint(message).empty() ? 0 : 1;
  }
  EXPECT_GT(n_refused, 1000);
}

}  // namespace

}  // namespace couplet::wire
