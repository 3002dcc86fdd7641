// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "ltm/core/file.h"
#include "reports/plain/findings.h"
#include "reports/plain/forget_text.h"
#include "reports/plain/import_report.h"
#include "reports/plain/result_text.h"
#include "reports/plain/save.h"
#include "tests/datasets/fixtures.h"

namespace engram::reports {
namespace {

using datasets::testing::TemporaryDirectory;
using std::chrono::milliseconds;
using ::testing::HasSubstr;

const Time kTime = *parse_time("2022-02-18 13:06:56");
const ltm::MemoryId kCup = *ltm::MemoryId::parse("Objects/Things/kitchen/cup");

/// What a report writes to stdout.
template <typename F>
std::string printed(F report) {
  ::testing::internal::CaptureStdout();
  report();
  std::fflush(stdout);
  return ::testing::internal::GetCapturedStdout();
}

ltm::QueryResult answer() {
  ltm::SnapshotResult snapshot;
  snapshot.time = kTime;
  snapshot.instances.push_back({});
  snapshot.instances.back().data = idf::Dict{{"height", 0.25}};
  ltm::QueryResult result;
  result.add_entity(kCup).snapshots.push_back(std::move(snapshot));
  return result;
}

TEST(Findings, TellFaultsBeforeNotes) {
  const std::vector<ltm::Finding> findings{
      {ltm::Severity::kNote, "a.h5", "", "is left over", "remove it"},
      {ltm::Severity::kFault, "b.h5", "cup", "is torn", "recover it"}};
  EXPECT_EQ(printed([&] { print_findings(findings); }),
            "fault: b.h5: cup\n  what    is torn\n  to do   recover it\n\n"
            "note: a.h5\n  what    is left over\n  to do   remove it\n\n");
  const Json json = findings_json(findings);
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[1]["severity"], "fault");
  EXPECT_EQ(json[1]["object"], "cup");
}

TEST(Findings, AreCountedWithTheCheck) {
  ltm::CheckReport report;
  report.segments = 3;
  EXPECT_EQ(check_json(report, "robot.engram")["clean"], true);
  report.findings.push_back({ltm::Severity::kFault, "b.h5", "", "is torn", "recover it"});
  const Json json = check_json(report, "robot.engram");
  EXPECT_EQ(json["clean"], false);
  EXPECT_EQ(json["segments"], 3);
  EXPECT_EQ(json["findings"].size(), 1u);
}

TEST(ForgetText, TellsWhatGoesWhyAndWhatStays) {
  ltm::ForgetPlan plan;
  ltm::EntityForgetPlan& cup = plan.entities[kCup];
  cup.gone = {kTime, kTime + milliseconds(200)};
  cup.reasons["age"] = 2;
  cup.freed_bytes = 1500;
  cup.stays = 7;
  cup.shielded = 1;
  plan.freed_bytes = 1500;
  plan.store_bytes = 90'000;
  const std::string text = printed([&] { print_plan(plan); });
  for (const char* part :
       {"Objects/Things/kitchen/cup\n", "goes   2 snapshots, ", "about 1.5 kB", "2 age\n",
        "stays  7, 1 of them protected\n", "In all 2 snapshots, about 1.5 kB of 90.0 kB\n"})
    EXPECT_THAT(text, HasSubstr(part));
  const Json json = plan_json(plan);
  EXPECT_EQ(json["snapshots"], 2);
  EXPECT_EQ(json["entities"][0]["times_ns"][1], to_ns(kTime + milliseconds(200)));
  EXPECT_EQ(json["entities"][0]["protected"], 1);
}

Status show_result(const ltm::QueryResult& result, const std::string& save, bool is_json) {
  ResultWriter writer(save, is_json);
  ENGRAM_RETURN_IF_ERROR(writer.add(result));
  writer.finish(result.is_ids_only());
  return {};
}

TEST(ResultText, ShowsPartsAsOneAnswer) {
  const ltm::MemoryId plate = *ltm::MemoryId::parse("Objects/Things/kitchen/plate");
  ltm::QueryResult whole;
  whole.add_entity(kCup);
  whole.add_entity(plate);
  std::vector<ltm::QueryResult> parts(4);
  parts[0].add_entity(kCup);
  for (int i = 0; i < 5; ++i) {
    ltm::SnapshotResult snapshot;
    snapshot.time = kTime + milliseconds(i);
    snapshot.instances.push_back({});
    snapshot.instances.back().data = idf::Dict{{"height", 0.25 * i}};
    whole.add_entity(plate).add(snapshot);
    parts[static_cast<size_t>(i) / 2].add_entity(plate).add(snapshot);
  }
  parts[3].add_entity(plate);  // Nothing more of it.
  for (const bool is_json : {false, true}) {
    const std::string at_once = printed([&] { EXPECT_TRUE(show_result(whole, "", is_json).ok()); });
    const std::string one_by_one = printed([&] {
      ResultWriter writer("", is_json);
      for (const ltm::QueryResult& part : parts) EXPECT_TRUE(writer.add(part).ok());
      writer.finish(false);
    });
    EXPECT_EQ(one_by_one, at_once);
    if (!is_json) continue;
    const Json json = Json::parse(at_once);
    EXPECT_EQ(json.dump(2) + "\n", at_once) << "as one JSON is printed";
    EXPECT_EQ(json["entities"][0]["snapshots"].size(), 0u);
    EXPECT_EQ(json["entities"][1]["snapshots"].size(), 5u);
  }
  const std::string nothing =
      printed([&] { EXPECT_TRUE(show_result(ltm::QueryResult(), "", true).ok()); });
  EXPECT_EQ(nothing, "{\n  \"entities\": []\n}\n");
}

TEST(ResultText, ShowsAnAnswerAsATableAndAsJson) {
  const ltm::QueryResult result = answer();
  const std::string text = printed([&] { EXPECT_TRUE(show_result(result, "", false).ok()); });
  EXPECT_THAT(text, HasSubstr("Objects/Things/kitchen/cup\n  time"));
  EXPECT_THAT(text, HasSubstr(to_string(kTime)));
  EXPECT_THAT(text, HasSubstr("{\"height\":0.25}"));
  const Json json = Json::parse(printed([&] { EXPECT_TRUE(show_result(result, "", true).ok()); }));
  ASSERT_EQ(json["entities"].size(), 1u);
  EXPECT_EQ(json["entities"][0]["id"], kCup.to_string());
  EXPECT_EQ(json["entities"][0]["snapshots"].size(), 1u);
}

TEST(ResultText, SavesWhatItShowsAndSaysWhereItCannot) {
  const TemporaryDirectory directory;
  const std::string folder = (directory / "out").string();
  const ltm::QueryResult result = answer();
  const std::string text = printed([&] { EXPECT_TRUE(show_result(result, folder, false).ok()); });
  EXPECT_THAT(text, HasSubstr("1 files written below " + folder));
  size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 1u);
  directory.write("taken", "");
  Status status;
  printed([&] { status = show_result(result, (directory / "taken").string(), false); });
  EXPECT_FALSE(status.ok());
}

TEST(ResultText, TellsContentsShortOrByTheirBeginning) {
  const auto content = [](idf::Data data) {
    return content_text(ltm::Snapshot{kCup, kTime, {{std::move(data), {}}}});
  };
  EXPECT_EQ(content(idf::Dict{{"a", 1.0}}), "{\"a\":1.0}");
  const std::string text = content(idf::Dict{{"text", std::string(200, 'x')}});
  EXPECT_TRUE(text.starts_with("{\"text\":\"xxx")) << text;
  EXPECT_TRUE(text.ends_with("...")) << text;
  EXPECT_EQ(text.size(), 60u);
}

TEST(ImportReport, CountsAVideoUnderTheNamesThatItAlwaysHad) {
  const TemporaryDirectory directory;
  ltm::Recorder recorder = *ltm::Recorder::open(directory / "store", {});
  datasets::RecordingImportReport report;
  report.values = 15;
  report.counts = {{"frames", 10}, {"rows", 5}};
  report.reading.damaged = 1;
  report.reading.duplicate_images = 2;
  report.reading.rows_outside = 3;
  const Json json = import_json(report, recorder);
  EXPECT_EQ(json["frames"], 10);
  EXPECT_EQ(json["rows"], 5);
  EXPECT_EQ(json["damaged_frames"], 1);
  EXPECT_EQ(json["duplicate_frames"], 2);
  EXPECT_EQ(json["rows_outside_video"], 3);
  EXPECT_EQ(json["values"], 15);
  const std::string text = printed([&] { print_import(report, recorder); });
  EXPECT_THAT(text, HasSubstr("2 images repeat the one before exactly\n"));
  EXPECT_THAT(text, HasSubstr("3 rows lie outside of the video\n"));
  ASSERT_TRUE(recorder.close().ok());
}

TEST(ImportReport, TellsOfRecordingsWhatDidNotComeIn) {
  const TemporaryDirectory directory;
  ltm::Recorder recorder = *ltm::Recorder::open(directory / "store", {});
  datasets::RecordingImportReport report;
  report.values = 1500;
  report.episodes = 2;
  report.reading.not_carried["messages of foo/Bar"] = 4;
  const Json json = import_json(report, recorder);
  EXPECT_EQ(json["not_carried"]["messages of foo/Bar"], 4);
  EXPECT_FALSE(json.contains("frames"));
  const std::string text = printed([&] { print_import(report, recorder); });
  EXPECT_THAT(text, HasSubstr("1,500 values of 2 episodes\n"));
  EXPECT_THAT(text, HasSubstr("4  messages of foo/Bar\n"));
  ASSERT_TRUE(recorder.close().ok());
}

TEST(ImportReport, ListsWhatIsInARecording) {
  datasets::RecordingStream known{kCup, "/cup", 1234, {}};
  datasets::RecordingStream unknown{*ltm::MemoryId::parse("A/B/C/d"), "/d", 0, {}};
  const std::string text = printed([&] { show_streams("mcap", {known, unknown}, false); });
  EXPECT_THAT(text, HasSubstr("in the mcap"));
  EXPECT_THAT(text, HasSubstr("1,234"));
  EXPECT_THAT(text, HasSubstr("A/B/C/d       -"));
  const Json json = Json::parse(printed([&] { show_streams("mcap", {known}, true); }));
  EXPECT_EQ(json["format"], "mcap");
  EXPECT_EQ(json["streams"][0]["values"], 1234);
}

}  // namespace
}  // namespace engram::reports
