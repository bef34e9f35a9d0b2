// Scenes with random damage: whatever stands in a text, it is either a scene or complained about at a place in it.

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "proto/scene/message_parser.hpp"
#include "proto/scene/read_scene.hpp"
#include "proto/scene/scene_tokens.hpp"
#include "tests/unit/proto/scene/good_scene.hpp"

namespace couplet::scene {
namespace {

using google::protobuf::TextFormat;
using google::protobuf::util::MessageDifferencer;

class NoErrors : public google::protobuf::io::ErrorCollector {
  void AddError(int, int, const std::string&) override {}
};

bool library_reads(const std::string& text, v1::Scene& scene) {
  NoErrors silent;
  TextFormat::Parser parser;
  parser.RecordErrorsTo(&silent);
  return parser.ParseFromString(text, &scene);
}

// The line exists, and the column is in it or just behind its end.
bool is_place_in(const std::string& text, int line, int column) {
  if (line < 1 || column < 1) return false;
  std::size_t start = 0;
  for (int i = 1; i < line; ++i) {
    const std::size_t end = text.find('\n', start);
    if (end == std::string::npos) return false;
    start = end + 1;
  }
  const std::size_t length = std::min(text.find('\n', start), text.size()) - start;
  return column <= static_cast<int>(length) + 1;
}

// Accepted by us: the library builds the same message from it. Refused by us: at a place in the text, in one line.
void expect_scene_or_complaints(const std::string& text) {
  const ReadResult result = read_scene_text(text, "scene.txtpb", {});
  if (result.complaints.empty()) {
    v1::Scene expected;
    ASSERT_TRUE(library_reads(text, expected)) << text;
    EXPECT_TRUE(MessageDifferencer::Equals(result.file.scene, expected)) << text;
  }
  for (const Complaint& complaint : result.complaints) {
    EXPECT_TRUE(is_place_in(text, complaint.line, complaint.column)) << complaint.text() << "\n" << text;
    EXPECT_GT(complaint.sentence.size(), 10U) << text;
    EXPECT_EQ(complaint.sentence.find('\n'), std::string::npos) << complaint.text();
  }
}

std::string damaged_bytes(std::mt19937& random) {
  static const std::string bytes = "{}[]<>:;,.\"'#-+=/\\ \n\t0189eExXainfM_\xC3\xA4\x01\x7F";
  std::string text = good_scene;
  const int n_damages = 1 + static_cast<int>(random() % 3);
  for (int i = 0; i < n_damages && text.size() > 2; ++i) {
    const std::size_t place = random() % (text.size() - 1);
    switch (random() % 4) {
      case 0:
        text.erase(place, 1 + random() % 5);
        break;
      case 1:
        text.insert(place, 1, bytes[random() % bytes.size()]);
        break;
      case 2:
        std::swap(text[place], text[place + 1]);
        break;
      default:
        text[place] = bytes[random() % bytes.size()];
    }
  }
  return text;
}

std::string damaged_tokens(std::mt19937& random) {
  static const std::vector<Token> tokens = split_tokens(good_scene);
  std::vector<Token> damaged = tokens;
  const int n_damages = 1 + static_cast<int>(random() % 3);
  for (int i = 0; i < n_damages; ++i) {
    const std::size_t place = random() % damaged.size(), other = random() % damaged.size();
    switch (random() % 4) {
      case 0:
        damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(place));
        break;
      case 1:
        damaged.insert(damaged.begin() + static_cast<std::ptrdiff_t>(place), damaged[other]);
        break;
      case 2:
        std::swap(damaged[place], damaged[other]);
        break;
      default:
        damaged[place].word = damaged[other].word;
    }
  }
  std::string text;
  int line = 1;
  for (const Token& token : damaged) {
    text += token.line == line ? " " : "\n";
    line = token.line;
    text += token.word;
  }
  return text;
}

TEST(MutilatedScene, WithDamagedBytesIsASceneOrComplainedAbout) {
  std::mt19937 random(20161);
  for (int i = 0; i < 4000 && !HasFailure(); ++i) expect_scene_or_complaints(damaged_bytes(random));
}

TEST(MutilatedScene, WithDamagedWordsIsASceneOrComplainedAbout) {
  std::mt19937 random(20162);
  for (int i = 0; i < 4000 && !HasFailure(); ++i) expect_scene_or_complaints(damaged_tokens(random));
}

// The library joins two texts in a list; it reads 1e999 as infinity. To us the one lacks a comma, the other is a slip.
bool is_stricter_on_purpose(const Complaint& complaint) {
  return complaint.sentence.find("a comma is missing") == 0 ||
         complaint.sentence.find("is too large for a number") != std::string::npos;
}

// The other way round: our parser is not stricter than the library.
TEST(MutilatedScene, IsReadWheneverTheLibraryReadsIt) {
  std::mt19937 random(20164);
  int n_read = 0;
  for (int i = 0; i < 10000 && !HasFailure(); ++i) {
    const std::string text = i % 2 == 0 ? damaged_bytes(random) : damaged_tokens(random);
    v1::Scene expected;
    if (!library_reads(text, expected)) continue;
    ++n_read;
    v1::Scene scene;
    FieldTree tree;
    ComplaintList complaints("scene.txtpb");
    MessageParser(text, "", complaints).parse_all(scene, tree);
    const std::vector<Complaint> found = complaints.in_order();
    if (std::any_of(found.begin(), found.end(), is_stricter_on_purpose)) continue;
    for (const Complaint& complaint : found) ADD_FAILURE() << complaint.text() << "\n" << text;
    EXPECT_TRUE(MessageDifferencer::Equals(scene, expected)) << text;
  }
  EXPECT_GT(n_read, 500);  // or the test would say nothing
}

TEST(MutilatedScene, CutOffAnywhereIsASceneOrComplainedAbout) {
  for (std::size_t length = 0; length <= good_scene.size() && !HasFailure(); ++length) {
    expect_scene_or_complaints(good_scene.substr(0, length));
  }
}

TEST(MutilatedScene, WithoutOneClosingBraceHasOneComplaintThatNamesABlock) {
  for (std::size_t place = good_scene.find('}'); place != std::string::npos; place = good_scene.find('}', place + 1)) {
    std::string text = good_scene;
    text.erase(place, 1);
    const std::vector<std::string> complaints = complaints_about(text);
    ASSERT_EQ(complaints.size(), 1U) << text << complaints[1];
    EXPECT_NE(complaints[0].find(": its { is not closed; add }"), std::string::npos) << complaints[0];
  }
}

TEST(MutilatedScene, OfRandomBytesIsComplainedAbout) {
  std::mt19937 random(20163);
  for (int i = 0; i < 500 && !HasFailure(); ++i) {
    std::string text(random() % 200, ' ');
    for (char& byte : text) byte = static_cast<char>(random() % 256);
    expect_scene_or_complaints(text);
    EXPECT_FALSE(complaints_about(text).empty());
  }
}

TEST(MutilatedScene, NestedDeeplyIsComplainedAbout) {
  std::string text = good_scene;
  for (int i = 0; i < 100000; ++i) text += "a{";
  EXPECT_FALSE(complaints_about(text).empty());
}

}  // namespace
}  // namespace couplet::scene
