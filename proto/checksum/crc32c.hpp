#pragma once
// The checksum of arrays on the wire, meshes and files: CRC-32C (Castagnoli, polynomial 0x1EDC6F41, reflected; RFC 3720
// appendix B.4).

#include <cstddef>
#include <cstdint>

namespace couplet::checksum {

/// CRC-32C of the bytes; crc32c("123456789") = 0xE3069283. A longer text is done in parts by passing on the value so
/// far.
std::uint32_t crc32c(const void* data, std::size_t size, std::uint32_t value_so_far = 0);

/// memcpy and crc32c in one pass over the memory: a block is still in the cache when its checksum is taken.
std::uint32_t copy_with_crc32c(void* to, const void* from, std::size_t size);

/// The same function without special instructions; crc32c uses it where the processor has none.
std::uint32_t crc32c_by_table(const void* data, std::size_t size, std::uint32_t value_so_far = 0);

}  // namespace couplet::checksum
