// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/datasets/fixtures.h"

namespace engram::datasets {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

Result<Table> read(std::string_view content, const Table::Options& options = {}) {
  const testing::TemporaryDirectory directory;
  return Table::read(directory.write("a.csv", content), options);
}

/// Expects an error whose message holds all of `words`.
void expect_rejected(std::string_view content, std::initializer_list<std::string_view> words,
                     const Table::Options& options = {}) {
  const auto table = read(content, options);
  ASSERT_EQ(table.status().code(), StatusCode::kInvalidArgument) << content;
  for (const std::string_view word : words)
    EXPECT_NE(table.status().message().find(word), std::string::npos)
        << "'" << word << "' is not in: " << table.status().message();
}

TEST(Table, ReadsEveryColumnAsDoubles) {
  const auto table = read("timestamp,count,angle\n0,1,2\n0.5,-2,2.5\n1,9007199254740992,-0\n");
  ASSERT_TRUE(table.ok()) << table.status().to_string();
  EXPECT_EQ(table->rows(), 3u);
  ASSERT_EQ(table->columns().size(), 2u);
  EXPECT_EQ(table->columns()[0].values, (std::vector<double>{1, -2, 9007199254740992.0}));
  const auto& angles = table->columns()[1].values;
  EXPECT_EQ(angles, (std::vector<double>{2, 2.5, 0}));
  EXPECT_TRUE(std::signbit(angles[2]));
}

TEST(Table, RejectsAnIntegerThatNoDoubleHolds) {
  expect_rejected("t,id\n0,9007199254740993\n", {"line 2", "'id'", "9007199254740993"});
}

TEST(Table, LeavesColumnsOut) {
  Table::Options options;
  options.skip_columns = {"name", "frame_index"};
  const auto table = read("frame_index,t,name,a\n0,0,apple,1.5\n1,1,pear,2.5\n", options);
  ASSERT_TRUE(table.ok()) << table.status().to_string();
  EXPECT_EQ(table->row_value(1), idf::Data(idf::Dict{{"a", 2.5}}));
}

TEST(Table, RejectsAColumnToLeaveOutThatIsNotThere) {
  Table::Options options;
  options.skip_columns = {"name"};
  expect_rejected("t,a\n0,1\n", {"line 1", "'name'"}, options);
}

TEST(Table, ReadsSpecialNumbersExactly) {
  const auto table = read(
      "t,a\n0,nan\n1,-inf\n2, 0.1 \n3,+1e300\n4,4.9406564584124654e-324\n5,99999999999999999999\n");
  ASSERT_TRUE(table.ok()) << table.status().to_string();
  const auto& values = table->columns()[0].values;
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_EQ(values[1], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(values[2], 0.1);
  EXPECT_EQ(values[3], 1e300);
  EXPECT_EQ(values[4], std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(values[5], 1e20);
}

TEST(Table, NestsNamesWithDotsInTheOrderOfColumns) {
  const auto table = read("state.left.elbow,n,time,state.right\n0.5,7,1,2.5\n");
  ASSERT_TRUE(table.ok()) << table.status().to_string();
  const idf::Data expected = idf::Dict{
      {"state", idf::Dict{{"left", idf::Dict{{"elbow", 0.5}}}, {"right", 2.5}}}, {"n", 7.0}};
  EXPECT_EQ(table->row_value(0), expected);
}

TEST(Table, AcceptsATimeColumnAlone) {
  const auto table = read("t\n0\n1\n");
  ASSERT_TRUE(table.ok()) << table.status().to_string();
  EXPECT_EQ(table->row_value(1), idf::Data(idf::Dict()));
}

TEST(Table, ReadsQuotesCrLfAndAByteOrderMark) {
  const auto table = read("\xef\xbb\xbf\"Timestamp\", \"a,b\"\r\n\"0.5\",\"3\"\r\n");
  EXPECT_FALSE(table.ok()) << "a blank before a quote is part of the cell";
  const auto plain = read("\xef\xbb\xbf\"Timestamp\",\"a,b\"\r\n\"0.5\",\"3\"\r\n");
  ASSERT_TRUE(plain.ok()) << plain.status().to_string();
  EXPECT_EQ(plain->columns()[0].name, "a,b");
  EXPECT_EQ(plain->times()[0], milliseconds(500));
}

TEST(Table, FindsTheTimeColumnByNameInAnyCase) {
  for (const char* name : {"timestamp", "TIME", "t", "Stamp"})
    EXPECT_TRUE(read(fmt::format("a,{}\n5,1\n", name)).ok()) << name;
  const auto table = read("time,clock\n5,1\n", {.time_column = "clock"});
  ASSERT_TRUE(table.ok());
  EXPECT_EQ(table->columns()[0].name, "time");
}

TEST(Table, KeepsTimesExactInEveryUnit) {
  const std::string_view content = "t,a\n1700000000123456789,1\n";
  EXPECT_EQ(read(content, {.time_unit = TimeUnit::kNanoseconds})->times()[0],
            nanoseconds(1700000000123456789));
  EXPECT_EQ(read("t,a\n1700000000.123456789,1\n")->times()[0], nanoseconds(1700000000123456789));
  EXPECT_EQ(read("t,a\n12.5,1\n", {.time_unit = TimeUnit::kMilliseconds})->times()[0],
            nanoseconds(12'500'000));
  EXPECT_EQ(read("t,a\n12.5,1\n", {.time_unit = TimeUnit::kMicroseconds})->times()[0],
            nanoseconds(12'500));
}

TEST(Table, RejectsACellThatIsNotNumeric) {
  expect_rejected("t,a,b\n0,1,2\n1,2,left\n", {"a.csv", "line 3", "column 'b'", "'left'"});
  expect_rejected("t,a\n0,\n", {"line 2", "column 'a'", "''"});
  expect_rejected("t,a\n0,1e999\n", {"line 2", "column 'a'", "1e999"});
  expect_rejected("t,a\n0,1 2\n", {"line 2", "column 'a'", "'1 2'"});
  expect_rejected("t,a\nsoon,1\n", {"line 2", "column 't'", "'soon'"});
}

TEST(Table, RejectsAWrongNumberOfCells) {
  expect_rejected("t,a\n0,1\n1\n", {"line 3", "1 cells", "needs 2"});
  expect_rejected("t,a\n0,1,2\n", {"line 2", "3 cells", "needs 2"});
}

TEST(Table, RejectsWhatIsNoTable) {
  expect_rejected("", {"empty", "header"});
  expect_rejected("t,a\n", {"no rows"});
  expect_rejected("0.0,1\n0.1,2\n", {"line 1", "only numbers", "header"});
  expect_rejected("a,b\n1,2\n", {"no time column", "timestamp"});
  expect_rejected("t,a\n1,2\n", {"'clock'"}, {.time_column = "clock"});
}

TEST(Table, RejectsNamesThatClash) {
  expect_rejected("t,a,a\n0,1,2\n", {"line 1", "column 'a'", "twice"});
  expect_rejected("t,a,a.b\n0,1,2\n", {"column 'a.b'", "column 'a'"});
  expect_rejected("t,a.b,a\n0,1,2\n", {"column 'a'", "column 'a.b'"});
  expect_rejected("t,a.b,a.b.c\n0,1,2\n", {"column 'a.b.c'", "column 'a.b'"});
  expect_rejected("t,a..b\n0,1\n", {"column 'a..b'"});
  expect_rejected(",t,a\n0,0,1\n", {"column 1", "no name"});
}

TEST(Table, RejectsATimeThatRepeatsOrRunsBackwards) {
  expect_rejected("t,a\n0,1\n0.5,1\n0.5,1\n", {"line 4", "column 't'", "'0.5' after '0.5'"});
  expect_rejected("t,a\n0,1\n0.5,1\n0.4,1\n", {"line 4", "'0.4' after '0.5'"});
  expect_rejected("t,a\n0,1\n0.0000000001,1\n", {"line 3"});
}

TEST(Table, SaysWhereThereIsNoFile) {
  EXPECT_EQ(Table::read("/nowhere/a.csv", {}).status().code(), StatusCode::kNotFound);
}

TEST(DecimalTime, IsExactAndRoundsHalfAwayFromZero) {
  const auto ns = [](std::string_view text) {
    return parse_decimal_time(text, TimeUnit::kSeconds)->count();
  };
  EXPECT_EQ(ns("0"), 0);
  EXPECT_EQ(ns("-1.5"), -1'500'000'000);
  EXPECT_EQ(ns("+.25"), 250'000'000);
  EXPECT_EQ(ns("3."), 3'000'000'000);
  EXPECT_EQ(ns("1e-3"), 1'000'000);
  EXPECT_EQ(ns("12.5E+2"), 1'250'000'000'000);
  EXPECT_EQ(ns("0.0000000004"), 0);
  EXPECT_EQ(ns("0.0000000005"), 1);
  EXPECT_EQ(ns("-0.0000000005"), -1);
  EXPECT_EQ(ns("1.2345678915"), 1'234'567'892);
  EXPECT_EQ(ns("0.99999999999"), 1'000'000'000);
  EXPECT_EQ(ns("1e-999"), 0);
  EXPECT_EQ(ns("9223372036.854775807"), std::numeric_limits<int64_t>::max());
  EXPECT_EQ(ns("0000000000000000000000001"), 1'000'000'000);
}

TEST(DecimalTime, RejectsWhatIsNoTime) {
  for (const char* text : {"", ".", "-", "+-1", "1e", "e5", "nan", "inf", "0x10", "1,5", "1.2.3",
                           "9223372036.854775808", "1e999", "1e99999999999999999999"})
    EXPECT_EQ(parse_decimal_time(text, TimeUnit::kSeconds).status().code(),
              StatusCode::kInvalidArgument)
        << text;
}

TEST(TimeUnit, ReadsTheFourUnits) {
  EXPECT_EQ(*parse_time_unit("s"), TimeUnit::kSeconds);
  EXPECT_EQ(*parse_time_unit("ms"), TimeUnit::kMilliseconds);
  EXPECT_EQ(*parse_time_unit("us"), TimeUnit::kMicroseconds);
  EXPECT_EQ(*parse_time_unit("ns"), TimeUnit::kNanoseconds);
  EXPECT_FALSE(parse_time_unit("min").ok());
}

TEST(Table, ReadsTheRealTablesWhole) {
  const auto data = testing::recordings();
  if (data.empty()) GTEST_SKIP() << "no recordings: set ENGRAM_RECORDINGS";
  const auto table = Table::read(data / "g1/tables/episode_000004.csv", {});
  ASSERT_TRUE(table.ok()) << table.status().to_string();
  EXPECT_EQ(table->rows(), 357u);
  EXPECT_EQ(table->columns().size(), 53u);
  EXPECT_EQ(table->times()[29], nanoseconds(966'667'000));
  const idf::Data row = table->row_value(29);
  EXPECT_EQ(row.at("frame_index")->get<double>(), 29);
  EXPECT_EQ(row.at("state/kLeftShoulderPitch")->get<double>(), -0.736515);
}

}  // namespace
}  // namespace engram::datasets
