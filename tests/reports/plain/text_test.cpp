// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace engram::reports {
namespace {

TEST(Text, PutsCommasBetweenThousands) {
  EXPECT_EQ(count_text(0), "0");
  EXPECT_EQ(count_text(999), "999");
  EXPECT_EQ(count_text(1000), "1,000");
  EXPECT_EQ(count_text(1234567), "1,234,567");
  EXPECT_EQ(count_text(std::numeric_limits<uint64_t>::max()), "18,446,744,073,709,551,615");
}

TEST(Text, GivesBytesThreeDigits) {
  EXPECT_EQ(bytes_text(0), "0 B");
  EXPECT_EQ(bytes_text(999), "999 B");
  EXPECT_EQ(bytes_text(999.6), "1.0 kB");
  EXPECT_EQ(bytes_text(1304), "1.3 kB");
  EXPECT_EQ(bytes_text(123456), "123 kB");
  EXPECT_EQ(bytes_text(35.7e6), "35.7 MB");
}

TEST(Text, GivesTimesInTheirLargestUnits) {
  EXPECT_EQ(seconds_text(-1), "0 s");
  EXPECT_EQ(seconds_text(59.4), "59 s");
  EXPECT_EQ(seconds_text(59.6), "1 min 00 s");
  EXPECT_EQ(seconds_text(125), "2 min 05 s");
  EXPECT_EQ(seconds_text(3720), "1 h 02 min");
}

TEST(Text, HasADashForWhatThereIsNot) {
  const double none = std::nan("");
  EXPECT_EQ(db_text(none), "-");
  EXPECT_EQ(number_text(none), "-");
  EXPECT_EQ(error_text({none, none}), "-");
  EXPECT_EQ(db_text(31.839), "31.84 dB");
  EXPECT_EQ(number_text(0.01234), "0.01234");
}

TEST(Text, TellsErrorsOfImagesAndNumbers) {
  ltm::MeasuredError error;
  error.image_mse = 65.025;  // 30 dB on a range of 255.
  EXPECT_EQ(error_text(error), "30.00 dB");
  error.number_mse = 0.25;
  EXPECT_EQ(error_text(error), "30.00 dB, RMSE 0.5");
  error.image_mse = std::nan("");
  EXPECT_EQ(error_text(error), "RMSE 0.5");
}

TEST(TextTable, AlignsTheFirstColumnLeftAndTheOthersRight) {
  TextTable table({"name", "count"});
  table.add({"a", "1"});
  table.add({"longer", "1,000"});
  EXPECT_EQ(table.to_string("  "),
            "  name    count\n"
            "  a           1\n"
            "  longer  1,000");
}

TEST(TextTable, TakesRowsOfSeveralLengthsWithoutSpacesAtTheEnd) {
  TextTable table({"name", ""});
  table.add({"a"});
  table.add({"b", "2", "3"});
  EXPECT_EQ(table.to_string(), "name\na\nb     2  3");
}

}  // namespace
}  // namespace engram::reports
