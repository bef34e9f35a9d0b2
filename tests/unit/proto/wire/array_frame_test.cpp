#include "proto/wire/array_frame.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "proto/report/failure.hpp"

namespace couplet::wire {

namespace {

surface::NodeArray three_nodes() {
  surface::NodeArray values(3, 2);
  values << 1, -2.5, 3e300, 4, -0.0, std::numeric_limits<double>::denorm_min();
  return values;
}

std::string complaint(const v1::ArrayHeader& header, const Frame& frame) {
  try {
    unpack_node_array(header, frame, "solid");
  } catch (const report::PeerError& fault) {
    return fault.what();
  }
  return "";
}

TEST(ArrayFrame, ComesBackWithTheSameBits) {
  const surface::NodeArray values = three_nodes();
  const PackedArray packed = pack_array("force", "N", values);
  EXPECT_EQ(packed.header.name(), "force");
  EXPECT_EQ(packed.header.unit(), "N");
  EXPECT_EQ(packed.frame.size(), 48U);
  const auto back = unpack_node_array(packed.header, packed.frame, "solid");
  ASSERT_EQ(back.rows(), 3);
  ASSERT_EQ(back.cols(), 2);
  EXPECT_EQ(std::memcmp(back.data(), values.data(), 48), 0);
}

TEST(ArrayFrame, IsTheSameWhetherItIsCopiedOrHandedOver) {
  const PackedArray copied = pack_array("force", "N", static_cast<const surface::NodeArray&>(three_nodes()));
  const PackedArray handed = pack_array("force", "N", three_nodes());
  EXPECT_EQ(copied.header.SerializeAsString(), handed.header.SerializeAsString());
  EXPECT_EQ(copied.frame.text(), handed.frame.text());
}

TEST(ArrayFrame, HoldsRowsOneAfterTheOtherLittleEndian) {
  surface::NodeArray values(2, 2);
  values << 1, 2, 3, 4;
  const PackedArray packed = pack_array("a", "", values);
  const unsigned char two[8] = {0, 0, 0, 0, 0, 0, 0, 0x40};  // IEEE 754: 2.0 = 0x4000000000000000
  EXPECT_EQ(std::memcmp(packed.frame.data() + 8, two, 8), 0);
  EXPECT_EQ(packed.header.shape(0), 2);
  EXPECT_EQ(packed.header.shape(1), 2);
}

TEST(ArrayFrame, CarriesIndices) {
  surface::IndexArray values(3);
  values << 0, -1, std::numeric_limits<std::int64_t>::max();
  const PackedArray packed = pack_array("face_node", values);
  EXPECT_EQ(unpack_index_array(packed.header, packed.frame, "solid"), values);
}

TEST(ArrayFrame, MayBeEmpty) {
  const PackedArray packed = pack_array("force", "N", surface::NodeArray(0, 3));
  const auto back = unpack_node_array(packed.header, packed.frame, "solid");
  EXPECT_EQ(back.rows(), 0);
  EXPECT_EQ(back.cols(), 3);
}

TEST(ArrayFrame, RefusesAnyDamagedBit) {
  PackedArray packed = pack_array("force", "N", three_nodes());
  for (std::size_t byte = 0; byte < packed.frame.size(); ++byte) {
    packed.frame.data()[byte] ^= std::byte{4};
    EXPECT_EQ(
        complaint(packed.header, packed.frame),
        "solid: array 'force' was damaged on its way: its checksum does not agree; mend the program that sends it "
        "(proto/README.md, \"Arrays\")");
    packed.frame.data()[byte] ^= std::byte{4};
  }
  EXPECT_EQ(complaint(packed.header, packed.frame), "");
}

TEST(ArrayFrame, RefusesAMissingChecksum) {
  PackedArray packed = pack_array("force", "N", three_nodes());
  packed.header.clear_crc32c();
  EXPECT_NE(complaint(packed.header, packed.frame).find("comes without its checksum"), std::string::npos);
}

TEST(ArrayFrame, RefusesAByteCountThatDoesNotFitTheShape) {
  PackedArray packed = pack_array("force", "N", three_nodes());
  packed.header.set_shape(0, 4);
  EXPECT_NE(
      complaint(packed.header, packed.frame).find("array 'force' of shape (4, 2) needs 64 bytes, its frame has 48"),
      std::string::npos);
}

TEST(ArrayFrame, RefusesShapesThatAreNegativeOrTooLargeForAnyMemory) {
  PackedArray packed = pack_array("force", "N", three_nodes());
  packed.header.set_shape(0, -3);
  EXPECT_NE(complaint(packed.header, packed.frame).find("impossible shape (-3, 2)"), std::string::npos);
  // 2^61 * 8 * 2 = 2^65 wraps around to 0 bytes.
  packed.header.set_shape(0, std::int64_t{1} << 61);
  EXPECT_NE(complaint(packed.header, Frame()).find("impossible shape"), std::string::npos);
  packed.header.set_shape(0, -3);
  packed.header.set_shape(1, -2);
  EXPECT_NE(complaint(packed.header, packed.frame).find("impossible shape (-3, -2)"), std::string::npos);
  // A large number of rows of no columns is as many bytes as it says, yet nothing to be believed.
  packed.header.set_shape(0, std::int64_t{1} << 60);
  packed.header.set_shape(1, 0);
  EXPECT_NE(complaint(packed.header, Frame()), "");
}

TEST(ArrayFrame, RefusesTheWrongKindOfNumberAndTheWrongNumberOfDimensions) {
  PackedArray packed = pack_array("force", "N", three_nodes());
  EXPECT_THROW(unpack_index_array(packed.header, packed.frame, "solid"), report::PeerError);
  packed.header.set_scalar_type(v1::ArrayHeader::INT64);
  EXPECT_NE(complaint(packed.header, packed.frame).find("holds INT64 where FLOAT64 is needed"), std::string::npos);
  packed.header.set_scalar_type(v1::ArrayHeader::FLOAT64);
  packed.header.add_shape(1);
  EXPECT_NE(complaint(packed.header, packed.frame).find("has shape (3, 2, 1) where 2 numbers are needed"),
            std::string::npos);
}

}  // namespace

}  // namespace couplet::wire
