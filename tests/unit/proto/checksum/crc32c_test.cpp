#include "proto/checksum/crc32c.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace couplet::checksum {

namespace {

std::vector<unsigned char> random_bytes(std::size_t size) {
  std::mt19937 generator(7);
  std::vector<unsigned char> bytes(size);
  for (auto& byte : bytes) byte = static_cast<unsigned char>(generator());
  return bytes;
}

// RFC 3720, appendix B.4, and the usual check value of this polynomial.
TEST(Crc32c, HasThePublishedValues) {
  const std::vector<unsigned char> zeros(32, 0), ones(32, 0xFF);
  EXPECT_EQ(crc32c(zeros.data(), 32), 0x8A9136AAU);
  EXPECT_EQ(crc32c(ones.data(), 32), 0x62A8AB43U);
  EXPECT_EQ(crc32c("123456789", 9), 0xE3069283U);
  EXPECT_EQ(crc32c_by_table("123456789", 9), 0xE3069283U);
  EXPECT_EQ(crc32c("", 0), 0U);
}

TEST(Crc32c, IsTheSameByInstructionAndByTableForEveryLengthAndAlignment) {
  const auto bytes = random_bytes(20'000);
  for (const std::size_t start : {0U, 1U, 3U, 7U})
    for (std::size_t size : {0U, 1U, 7U, 8U, 9U, 3071U, 3072U, 3073U, 6144U, 9221U, 19'000U})
      EXPECT_EQ(crc32c(&bytes[start], size), crc32c_by_table(&bytes[start], size)) << start << " " << size;
}

TEST(Crc32c, OfPartsIsThatOfTheWhole) {
  const auto bytes = random_bytes(10'000);
  const std::uint32_t whole = crc32c(bytes.data(), bytes.size());
  for (const std::size_t cut : {0U, 1U, 3072U, 5000U, 10'000U})
    EXPECT_EQ(crc32c(bytes.data() + cut, bytes.size() - cut, crc32c(bytes.data(), cut)), whole);
}

TEST(Crc32c, ChangesWithAnySingleBit) {
  auto bytes = random_bytes(100);
  const std::uint32_t whole = crc32c(bytes.data(), bytes.size());
  for (std::size_t bit = 0; bit < 800; ++bit) {
    bytes[bit / 8] ^= static_cast<unsigned char>(1U << bit % 8);
    EXPECT_NE(crc32c(bytes.data(), bytes.size()), whole);
    bytes[bit / 8] ^= static_cast<unsigned char>(1U << bit % 8);
  }
}

TEST(Crc32c, ComesWithACopyAtNoExtraPass) {
  for (const std::size_t size : {0U, 1U, 12'287U, 12'288U, 12'289U, 100'001U}) {
    const auto bytes = random_bytes(size);
    std::vector<unsigned char> copy(size);
    EXPECT_EQ(copy_with_crc32c(copy.data(), bytes.data(), size), crc32c(bytes.data(), size));
    EXPECT_EQ(copy, bytes);
  }
}

}  // namespace

}  // namespace couplet::checksum
