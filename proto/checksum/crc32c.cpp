#include "proto/checksum/crc32c.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#ifdef __SSE4_2__
#include <nmmintrin.h>
#endif

namespace couplet::checksum {

namespace {

constexpr std::uint32_t polynomial = 0x82F63B78;  // 0x1EDC6F41 with its bits reversed

using ByteTable = std::array<std::uint32_t, 256>;

// table[k][b]: what byte b does to the remainder when k more bytes follow it.
constexpr std::array<ByteTable, 8> make_byte_tables() {
  std::array<ByteTable, 8> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ ((remainder & 1) != 0 ? polynomial : 0);
    table[0][byte] = remainder;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      table[k][byte] = (table[k - 1][byte] >> 8) ^ table[0][table[k - 1][byte] & 0xFF];
  return table;
}

constexpr auto byte_table = make_byte_tables();

std::uint32_t remainder_by_table(const unsigned char* bytes, std::size_t size, std::uint32_t remainder) {
  for (; size >= 8; bytes += 8, size -= 8) {
    const std::uint32_t low = remainder ^ (std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8 |
                                           std::uint32_t{bytes[2]} << 16 | std::uint32_t{bytes[3]} << 24);
    remainder = byte_table[7][low & 0xFF] ^ byte_table[6][(low >> 8) & 0xFF] ^ byte_table[5][(low >> 16) & 0xFF] ^
                byte_table[4][low >> 24] ^ byte_table[3][bytes[4]] ^ byte_table[2][bytes[5]] ^ byte_table[1][bytes[6]] ^
                byte_table[0][bytes[7]];
  }
  for (; size > 0; ++bytes, --size) remainder = (remainder >> 8) ^ byte_table[0][(remainder ^ *bytes) & 0xFF];
  return remainder;
}

#ifdef __SSE4_2__

// The instruction takes three cycles but one can start in each, so three parts of a block are done side by side.
constexpr std::size_t part = 1024;  // [bytes]

// shift[k][b]: what byte k of the remainder, when it is b, becomes after `part` zero bytes. The remainder is linear in
// the bits, so remainder(A B) = shifted remainder(A) ^ remainder(B).
constexpr std::array<ByteTable, 4> make_shift_tables() {
  std::array<std::uint32_t, 32> of_bit{};
  for (std::uint32_t bit = 0; bit < 32; ++bit) {
    std::uint32_t remainder = std::uint32_t{1} << bit;
    for (std::size_t i = 0; i < part; ++i) remainder = (remainder >> 8) ^ byte_table[0][remainder & 0xFF];
    of_bit[bit] = remainder;
  }
  std::array<ByteTable, 4> shift{};
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      for (std::size_t bit = 0; bit < 8; ++bit)
        if ((byte >> bit & 1) != 0) shift[k][byte] ^= of_bit[8 * k + bit];
  return shift;
}

constexpr auto shift_table = make_shift_tables();

std::uint64_t shifted(std::uint64_t remainder) {
  return shift_table[0][remainder & 0xFF] ^ shift_table[1][(remainder >> 8) & 0xFF] ^
         shift_table[2][(remainder >> 16) & 0xFF] ^ shift_table[3][(remainder >> 24) & 0xFF];
}

std::uint64_t eight_bytes(const unsigned char* bytes) {
  std::uint64_t value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

std::uint32_t remainder_by_instruction(const unsigned char* bytes, std::size_t size, std::uint32_t start) {
  std::uint64_t remainder = start;
  for (; size >= 3 * part; bytes += 3 * part, size -= 3 * part) {
    std::uint64_t second = 0, third = 0;
    for (std::size_t i = 0; i < part; i += 8) {
      remainder = _mm_crc32_u64(remainder, eight_bytes(bytes + i));
      second = _mm_crc32_u64(second, eight_bytes(bytes + part + i));
      third = _mm_crc32_u64(third, eight_bytes(bytes + 2 * part + i));
    }
    remainder = shifted(shifted(remainder) ^ second) ^ third;
  }
  for (; size >= 8; bytes += 8, size -= 8) remainder = _mm_crc32_u64(remainder, eight_bytes(bytes));
  auto value = static_cast<std::uint32_t>(remainder);
  for (; size > 0; ++bytes, --size) value = _mm_crc32_u8(value, *bytes);
  return value;
}

#endif

}  // namespace

std::uint32_t crc32c_by_table(const void* data, std::size_t size, std::uint32_t value_so_far) {
  return ~remainder_by_table(static_cast<const unsigned char*>(data), size, ~value_so_far);
}

std::uint32_t crc32c(const void* data, std::size_t size, std::uint32_t value_so_far) {
#ifdef __SSE4_2__
  return ~remainder_by_instruction(static_cast<const unsigned char*>(data), size, ~value_so_far);
#else
  return crc32c_by_table(data, size, value_so_far);
#endif
}

std::uint32_t copy_with_crc32c(void* to, const void* from, std::size_t size) {
  constexpr std::size_t block = 12 * 1024;  // [bytes], stays in the first-level cache; a multiple of three parts
  std::uint32_t value = 0;
  for (std::size_t done = 0; done < size; done += block) {
    const std::size_t n = std::min(block, size - done);
    std::memcpy(static_cast<std::byte*>(to) + done, static_cast<const std::byte*>(from) + done, n);
    value = crc32c(static_cast<const std::byte*>(from) + done, n, value);
  }
  return value;
}

}  // namespace couplet::checksum
