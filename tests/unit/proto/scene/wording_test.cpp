#include "proto/scene/wording.hpp"

#include <gtest/gtest.h>

namespace couplet::scene {
namespace {

TEST(Wording, WritesNumbersShortAndExact) {
  EXPECT_EQ(number_text(0.5), "0.5");
  EXPECT_EQ(number_text(100000), "100000");
  EXPECT_EQ(number_text(1e-5), "1e-05");
  EXPECT_EQ(number_text(-1040), "-1040");
  EXPECT_EQ(std::stod(number_text(1.0 / 3)), 1.0 / 3);
}

TEST(Wording, FindsTheNearestName) {
  const std::vector<std::string> names = {"density", "viscosity", "young_modulus"};
  EXPECT_EQ(nearest_name("densty", names), "density");
  EXPECT_EQ(nearest_name("dnesity", names), "density");
  EXPECT_EQ(nearest_name("DENSITY", names), "density");
  EXPECT_EQ(nearest_name("young", names), "young_modulus");
  EXPECT_EQ(nearest_name("colour", names), "");
}

TEST(Wording, FindsNoNearestNameAmongEqualOnes) {
  EXPECT_EQ(nearest_name("M3", {"M1", "M2"}), "");
  EXPECT_EQ(nearest_name("m2", {"M1", "M2"}), "M2");
}

TEST(Wording, ShowsWhatAUserWroteOnOneLine) {
  EXPECT_EQ(on_one_line("a\nb\x7F \xC2\xB5m"), "a?b? \xC2\xB5m");
  EXPECT_EQ(on_one_line("K\xF6rper"), "K?rper");
  EXPECT_EQ(on_one_line(std::string(500, 'x') + " end"), std::string(199, 'x') + "... end");
  std::string long_word = "x";
  for (int i = 0; i < 300; ++i) long_word += "\xC2\xB5";
  EXPECT_TRUE(is_utf8(on_one_line(long_word)));
}

TEST(Wording, KnowsUtf8) {
  for (const std::string text : {"", "abc", "\xC2\xB5", "\xE2\x82\xAC", "\xF0\x9F\x8E\xB5"})
    EXPECT_TRUE(is_utf8(text)) << text;
  for (const std::string text :
       {"\x80", "\xC3", "\xC0\xAF", "\xE0\x80\x80", "\xED\xA0\x80", "\xF5\x80\x80\x80", "a\xFFz"}) {
    EXPECT_FALSE(is_utf8(text)) << text;
  }
}

TEST(Wording, ListsNames) {
  EXPECT_EQ(either_of({"a"}), "a");
  EXPECT_EQ(either_of({"a", "b", "c"}), "a, b or c");
}

}  // namespace
}  // namespace couplet::scene
