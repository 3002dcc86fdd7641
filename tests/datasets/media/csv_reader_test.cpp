// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/csv_reader.h"

#include <gtest/gtest.h>

#include "tests/datasets/fixtures.h"

namespace engram::datasets {
namespace {

using Records = std::vector<std::vector<std::string>>;

/// All records of a file with this content, and the error that ended them.
struct Outcome {
  Records records;
  std::vector<uint64_t> lines;
  Status status;
};

Outcome read(std::string_view content) {
  const testing::TemporaryDirectory directory;
  auto reader = CsvReader::open(directory.write("a.csv", content));
  EXPECT_TRUE(reader.ok()) << reader.status().to_string();
  Outcome outcome;
  std::vector<std::string> cells;
  while (true) {
    const auto has_record = reader->next(cells);
    if (!has_record.ok()) outcome.status = has_record.status();
    if (!has_record.ok() || !*has_record) return outcome;
    outcome.records.push_back(cells);
    outcome.lines.push_back(reader->line());
  }
}

TEST(CsvReader, SplitsRecordsAtCommasAndLines) {
  EXPECT_EQ(read("a,b\n1,\n,2").records, (Records{{"a", "b"}, {"1", ""}, {"", "2"}}));
}

TEST(CsvReader, ReadsQuotedCommasQuotesAndLineBreaks) {
  const Outcome outcome = read("\"a,b\",\"say \"\"hi\"\"\"\n\"two\r\nlines\",\"\"\nx,y\n");
  EXPECT_EQ(outcome.records, (Records{{"a,b", "say \"hi\""}, {"two\r\nlines", ""}, {"x", "y"}}));
  EXPECT_EQ(outcome.lines, (std::vector<uint64_t>{1, 2, 4}));
}

TEST(CsvReader, AcceptsCrLfAByteOrderMarkAndEmptyLines) {
  const Outcome outcome = read(
      "\xef\xbb\xbf"
      "a,b\r\n\r\n1,2\r\n\n\n");
  EXPECT_EQ(outcome.records, (Records{{"a", "b"}, {"1", "2"}}));
  EXPECT_EQ(outcome.lines, (std::vector<uint64_t>{1, 3}));
}

TEST(CsvReader, FindsNothingInAnEmptyFile) {
  EXPECT_TRUE(read("").records.empty());
  EXPECT_TRUE(read("\xef\xbb\xbf").records.empty());
  EXPECT_TRUE(read("\n\r\n").records.empty());
}

TEST(CsvReader, NamesTheLineOfAQuoteThatNeverCloses) {
  const Outcome outcome = read("a\n\"b\nc\nd\n");
  EXPECT_EQ(outcome.status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(outcome.status.message().find("line 2"), std::string::npos) << outcome.status.message();
}

TEST(CsvReader, RejectsTextBesideQuotesAndALoneCarriageReturn) {
  for (const char* content : {"a\n\"b\"c\n", "a\nb\"c\n", "a\nb\rc\n"})
    EXPECT_EQ(read(content).status.code(), StatusCode::kInvalidArgument) << content;
}

TEST(CsvReader, RejectsACellThatIsTooLong) {
  const std::string huge(size_t{2} << 20, 'x');
  EXPECT_EQ(read(huge).status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(read("\"" + huge).status.code(), StatusCode::kInvalidArgument);
}

TEST(CsvReader, KeepsRecordsWholeAcrossReadsOfTheFile) {
  std::string content;
  Records expected;
  for (int i = 0; i < 60'000; ++i) {
    expected.push_back({std::to_string(i), "\"" + std::to_string(i)});
    content += fmt::format("{},\"\"\"{}\"\r\n", i, i);
  }
  EXPECT_EQ(read(content).records, expected);
}

TEST(CsvReader, SurvivesAnyBytes) {
  uint32_t state = 1;
  for (int round = 0; round < 500; ++round) {
    std::string content;
    for (int i = 0; i < 60; ++i) {
      state = state * 1664525 + 1013904223;
      content += "\"\",,\r\n\n1a.\0\xff"[(state >> 24) % 13];
    }
    read(content);
  }
}

TEST(CsvReader, SaysWhereThereIsNoFile) {
  const testing::TemporaryDirectory directory;
  EXPECT_EQ(CsvReader::open(directory / "none.csv").status().code(), StatusCode::kNotFound);
  EXPECT_EQ(CsvReader::open(directory / ".").status().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::datasets
