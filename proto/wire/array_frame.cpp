#include "proto/wire/array_frame.hpp"

#include <bit>
#include <memory>
#include <utility>

#include "proto/checksum/crc32c.hpp"
#include "proto/report/failure.hpp"

namespace couplet::wire {

static_assert(std::endian::native == std::endian::little, "arrays travel little-endian; swap bytes here");

namespace {

v1::ArrayHeader make_header(const std::string& name, const std::string& unit, v1::ArrayHeader::ScalarType type) {
  v1::ArrayHeader header;
  header.set_name(name);
  header.set_scalar_type(type);
  if (!unit.empty()) header.set_unit(unit);
  return header;
}

v1::ArrayHeader node_header(const std::string& name, const std::string& unit, const surface::NodeArray& values) {
  v1::ArrayHeader header = make_header(name, unit, v1::ArrayHeader::FLOAT64);
  header.add_shape(values.rows());
  header.add_shape(values.cols());
  return header;
}

std::string shape_text(const v1::ArrayHeader& header) {
  std::string text = "(";
  for (int i = 0; i < header.shape_size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(header.shape(i));
  return text + ")";
}

[[noreturn]] void refuse(const v1::ArrayHeader& header, const std::string& whose, const std::string& sentence) {
  throw report::PeerError(whose, "array '" + header.name() + "' " + sentence,
                          "mend the program that sends it (proto/README.md, \"Arrays\")");
}

// Everything that is known before the numbers are read; afterwards the shape can be trusted.
void check(const v1::ArrayHeader& header, const Frame& frame, v1::ArrayHeader::ScalarType type, int dimensions,
           const std::string& whose) {
  if (header.scalar_type() != type) {
    refuse(header, whose,
           "holds " + v1::ArrayHeader::ScalarType_Name(header.scalar_type()) + " where " +
               v1::ArrayHeader::ScalarType_Name(type) + " is needed");
  }
  if (header.shape_size() != dimensions) {
    refuse(header, whose,
           "has shape " + shape_text(header) + " where " + std::to_string(dimensions) + " numbers are needed");
  }
  std::int64_t bytes = 8;  // of one number; both scalar types have as many
  for (const std::int64_t extent : header.shape()) {
    if (extent < 0 || __builtin_mul_overflow(bytes, extent, &bytes))
      refuse(header, whose, "has the impossible shape " + shape_text(header));
  }
  if (static_cast<std::uint64_t>(bytes) != frame.size()) {
    refuse(header, whose,
           "of shape " + shape_text(header) + " needs " + std::to_string(bytes) + " bytes, its frame has " +
               std::to_string(frame.size()));
  }
}

template <class Array>
void copy_checked(Array& values, const v1::ArrayHeader& header, const Frame& frame, const std::string& whose) {
  const std::uint32_t found = checksum::copy_with_crc32c(values.data(), frame.data(), frame.size());
  if (!header.has_crc32c()) refuse(header, whose, "comes without its checksum crc32c");
  if (found != header.crc32c()) refuse(header, whose, "was damaged on its way: its checksum does not agree");
}

}  // namespace

PackedArray pack_array(const std::string& name, const std::string& unit, const surface::NodeArray& values) {
  PackedArray packed{node_header(name, unit, values), Frame(static_cast<std::size_t>(values.size()) * sizeof(double))};
  packed.header.set_crc32c(checksum::copy_with_crc32c(packed.frame.data(), values.data(), packed.frame.size()));
  return packed;
}

PackedArray pack_array(const std::string& name, const std::string& unit, surface::NodeArray&& values) {
  const auto owner = std::make_shared<surface::NodeArray>(std::move(values));
  const std::size_t size = static_cast<std::size_t>(owner->size()) * sizeof(double);
  PackedArray packed{node_header(name, unit, *owner), Frame::inside(owner, owner->data(), size)};
  packed.header.set_crc32c(checksum::crc32c(owner->data(), size));
  return packed;
}

PackedArray pack_array(const std::string& name, const surface::IndexArray& values) {
  PackedArray packed{make_header(name, "", v1::ArrayHeader::INT64),
                     Frame(static_cast<std::size_t>(values.size()) * sizeof(std::int64_t))};
  packed.header.add_shape(values.size());
  packed.header.set_crc32c(checksum::copy_with_crc32c(packed.frame.data(), values.data(), packed.frame.size()));
  return packed;
}

surface::NodeArray unpack_node_array(const v1::ArrayHeader& header, const Frame& frame, const std::string& whose) {
  check(header, frame, v1::ArrayHeader::FLOAT64, 2, whose);
  surface::NodeArray values(header.shape(0), header.shape(1));
  copy_checked(values, header, frame, whose);
  return values;
}

surface::IndexArray unpack_index_array(const v1::ArrayHeader& header, const Frame& frame, const std::string& whose) {
  check(header, frame, v1::ArrayHeader::INT64, 1, whose);
  surface::IndexArray values(header.shape(0));
  copy_checked(values, header, frame, whose);
  return values;
}

}  // namespace couplet::wire
