#include "proto/scene/field_facts.hpp"
#include "proto/scene/relation_rules.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

using google::protobuf::Message;

void something_is_computed(const v1::Scene& scene, Review& review) {
  if (scene.has_flow() || scene.has_solid()) return;
  review.complain_missing_choice("", {"flow", "solid"},
                                 "neither flow nor solid is given; give flow { ... }, solid { ... } or both");
}

void step_fits_into_the_run(const v1::Time& time, Review& review) {
  if (!(time.end() > 0) || !(time.step() > time.end())) return;
  review.complain("time.step", number_text(time.step()) + " s is longer than the run of " + number_text(time.end()) +
                                   " s; give a shorter step or a later end");
}

/// A year of steps of 30 ms: what takes more is a slip of the pen.
constexpr double most_steps = 1e9;

void run_has_an_end(const v1::Time& time, Review& review) {
  if (!(time.step() > 0) || !(time.end() > most_steps * time.step())) return;
  review.complain("time.step", number_text(time.step()) + " s makes more than " + number_text(most_steps) +
                                   " steps to the end at " + number_text(time.end()) +
                                   " s; give a longer step or an earlier end");
}

void rows_rise(const v1::TimeTable& table, const std::string& path, Review& review) {
  for (int i = 1; i < table.row_size(); ++i) {
    const v1::TimeTable::Row &before = table.row(i - 1), &row = table.row(i);
    if (!before.has_time() || !row.has_time() || !(row.time() <= before.time())) continue;
    review.complain(path + ".row[" + std::to_string(i) + "].time",
                    number_text(row.time()) + " s is not later than the row before, " + number_text(before.time()) +
                        " s; put the rows into rising order");
  }
}

// Every time table inside a message, wherever the schema has one.
void check_time_tables(const Message& message, const std::string& path, Review& review) {
  if (const auto* const table = dynamic_cast<const v1::TimeTable*>(&message)) {
    rows_rise(*table, path, review);
    return;
  }
  std::vector<const FieldDescriptor*> given;
  message.GetReflection()->ListFields(message, &given);
  for (const FieldDescriptor* const field : given) {
    if (!is_message(*field)) continue;
    const std::string inner = path.empty() ? field->name() : path + "." + field->name();
    if (!field->is_repeated()) {
      check_time_tables(message.GetReflection()->GetMessage(message, field), inner, review);
      continue;
    }
    for (int i = 0; i < message.GetReflection()->FieldSize(message, field); ++i) {
      check_time_tables(message.GetReflection()->GetRepeatedMessage(message, field, i),
                        inner + "[" + std::to_string(i) + "]", review);
    }
  }
}

}  // namespace

void check_time_rules(const v1::Scene& scene, Review& review) {
  something_is_computed(scene, review);
  step_fits_into_the_run(scene.time(), review);
  run_has_an_end(scene.time(), review);
  check_time_tables(scene, "", review);
}

}  // namespace couplet::scene
