#include "proto/scene/make_time_table.hpp"

namespace couplet::scene {

TimeTable make_time_table(const v1::TimeTable& table) {
  TimeTable plain;
  for (const v1::TimeTable::Row& row : table.row()) {
    plain.time.push_back(row.time());
    plain.value.push_back(row.value());
  }
  plain.cosine = table.interpolation() == v1::TimeTable::COSINE;
  return plain;
}

}  // namespace couplet::scene
