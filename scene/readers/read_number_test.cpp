// Numbers in texts.
#include "scene/readers/read_number.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace umbrage {
namespace {

TEST(ReadNumber, TakesWhatFilesHave) {
  const std::pair<std::string, double> kNumbers[] = {
      {"1", 1.0},      {"+1", 1.0},     {"-1", -1.0},     {"1.", 1.0},     {".5", 0.5}, {"+.5", 0.5},
      {"-.5e1", -5.0}, {"1e3", 1000.0}, {"1E+3", 1000.0}, {"2e-3", 0.002}, {"-0", -0.0}};
  for (const auto& [text, value] : kNumbers) {
    ASSERT_TRUE(number_of(text)) << text;
    EXPECT_EQ(*number_of(text), value) << text;
    EXPECT_EQ(std::signbit(*number_of(text)), std::signbit(value)) << text;
  }
  EXPECT_TRUE(std::isnan(number_of("nan").value_or(0.0)));
  EXPECT_EQ(number_of("-inf"), -HUGE_VAL);
}

TEST(ReadNumber, BeyondTheRangeIsInfiniteOrZero) {
  const std::string zeros(400, '0');
  for (const std::string& small : {std::string("1e-400"), "0." + zeros + "1", "0." + zeros + "1e+20",
                                   std::string("12e-9999999999999999999"), "1" + zeros + "e-999"})
    EXPECT_EQ(number_of(small), 0.0) << small;
  for (const std::string& large : {std::string("1e400"), "1" + zeros, "1" + zeros + ".5", std::string("0.01e+999"),
                                   std::string("1e9999999999999999999"), "1" + zeros + "e-9"}) {
    EXPECT_EQ(number_of(large), HUGE_VAL) << large;
    EXPECT_EQ(number_of("-" + large), -HUGE_VAL) << large;
  }
}

TEST(ReadNumber, StopsAfterTheNumber) {
  const std::pair<std::string, std::size_t> kTexts[] = {{"1 2", 1},     {"1,2", 1},   {"1.5.2", 3}, {"2x", 1},
                                                        {"1e", 1},      {"1e+ 2", 1}, {"0x10", 1},  {"1\r\n", 1},
                                                        {"1e400/2", 5}, {"+3;", 2}};
  for (const auto& [text, length] : kTexts) {
    const char* at = text.data();
    double value = 0.0;
    EXPECT_TRUE(read_number(at, text.data() + text.size(), value)) << text;
    EXPECT_EQ(std::size_t(at - text.data()), length) << text;
    EXPECT_FALSE(number_of(text)) << text;
  }
  for (const char* text : {"", "+", "-", ".", "+-1", "++1", "-+1", "--1", "e5", "x", " 1"})
    EXPECT_FALSE(number_of(text)) << text;
}

TEST(ReadNumber, RoundsAsTheStandardLibrary) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::ldexp(double(random()), int(random() % 100) - 90);
    for (const std::string& text :
         {fmt::format("{}", value), fmt::format("{:.6f}", value), fmt::format("{:.{}g}", value, 1 + i % 17)})
      ASSERT_EQ(number_of(text), std::strtod(text.c_str(), nullptr)) << text;
  }
}

}  // namespace
}  // namespace umbrage
