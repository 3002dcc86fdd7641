// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/tum_writer.h"

#include "datasets/folders/folder_formats.h"
#include "datasets/recordings/import_recording.h"
#include "ltm/codec/png.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

class TumWriterTest : public ::testing::Test {
 protected:
  void write(const std::string& name, std::string_view content) {
    std::filesystem::create_directories((scratch_ / name).parent_path());
    overwrite_file(scratch_ / name, as_bytes(content));
  }

  void write_folder() {
    const auto rgb = ltm::png_codec().encode(idf::NdArray::take<uint8_t>({1, 1, 3}, {1, 2, 3}));
    const auto depth = ltm::png_codec().encode(idf::NdArray::take<uint16_t>({1, 1, 1}, {5000}));
    ASSERT_OK(rgb);
    ASSERT_OK(depth);
    write("in/rgb/1.png", as_text(*rgb));
    write("in/depth/1.png", as_text(*depth));
    write("in/rgb.txt", "1305031102.175304 rgb/1.png\n");
    write("in/depth.txt", "1305031102.160407001 depth/1.png\n");
    write("in/groundtruth.txt", "1305031102.175304 1.5 -2 3e-17 0.1 0.2 0.3 0.9\n");
    write("in/accelerometer.txt", "1305031102.2 0 0.1 9.81\n");
  }

  Status import_folder(const std::string& folder, const std::string& store) {
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, make_tum_format()->open(scratch_ / folder, {}));
    ENGRAM_ASSIGN_OR_RETURN(auto recorder, ltm::Recorder::open(scratch_ / store, {}));
    ENGRAM_ASSIGN_OR_RETURN(const auto report, import_recording(*reader, "tum", recorder, {}, {}));
    EXPECT_EQ(report.reading, ReadingReport());
    return recorder.close();
  }

  Result<ExportReport> export_store(const std::string& store, const std::string& folder,
                                    const std::stop_token& stop = {}) {
    ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(scratch_ / store));
    ltm::Recall recall(std::move(reader), {});
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse("@ all"));
    ENGRAM_ASSIGN_OR_RETURN(not_held_, make_tum_format()->not_held(recall, query, {}));
    return make_tum_format()->write(recall, query, scratch_ / folder, {}, {}, stop);
  }

  std::vector<ltm::EntityUpdate> updates_of(const std::string& folder) const {
    std::vector<ltm::EntityUpdate> updates;
    const auto reader = make_tum_format()->open(scratch_ / folder, {});
    EXPECT_OK(reader);
    while (reader.ok()) {
      const auto moment = (*reader)->next();
      EXPECT_OK(moment);
      if (!moment.ok() || !*moment) break;
      for (const auto& update : (*moment)->commit.updates) updates.push_back(update);
    }
    return updates;
  }

  ScratchDirectory scratch_;
  std::map<std::string, uint64_t, std::less<>> not_held_;
};

TEST_F(TumWriterTest, WhatCameInGoesOutAndComesInAgain) {
  write_folder();
  ASSERT_OK(import_folder("in", "store"));
  const auto report = export_store("store", "out");
  ASSERT_OK(report);
  EXPECT_THAT(not_held_, IsEmpty());
  EXPECT_THAT(report->not_carried, IsEmpty());
  EXPECT_EQ(report->snapshots, 4u);
  EXPECT_EQ(report->files, 6u);
  const auto before = updates_of("in");
  const auto after = updates_of("out");
  ASSERT_EQ(before.size(), after.size());
  for (size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(before[i].entity, after[i].entity);
    EXPECT_EQ(before[i].time, after[i].time);
    EXPECT_EQ(before[i].instances[0].data, after[i].instances[0].data);
  }
  EXPECT_OK(import_folder("out", "again"));
}

TEST_F(TumWriterTest, SaysWhatIsNotHeldAndLeavesNothingWhereItStops) {
  {
    auto recorder = ltm::Recorder::open(scratch_ / "store", {});
    ASSERT_OK(recorder);
    ltm::Commit commit;
    for (const std::string name : {"Vision/RGB/robot/left", "Vision/RGB/robot/right"})
      commit.updates.push_back(
          {*ltm::MemoryId::parse(name),
           time_from_ns(1),
           {{idf::Dict{{"image", idf::NdArray::take<uint8_t>({1, 1, 1}, {1})}, {"state", "x"}},
             {}}}});
    commit.updates.push_back(
        {*ltm::MemoryId::parse("A/B/c/text"), time_from_ns(1), {{idf::Data("text"), {}}}});
    ASSERT_OK(recorder->commit(commit));
    ASSERT_OK(recorder->close());
  }
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS(export_store("store", "out", stop.get_token()), StatusCode::kCancelled,
               "nothing was kept");
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "out"));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / ".out.part"));
  ASSERT_OK(export_store("store", "out"));
  EXPECT_THAT(not_held_,
              ElementsAre(Pair("A/B/c/text, no image, depth, pose or accelerometer", 1),
                          Pair("Vision/RGB/robot/right, beside the first entity of rgb.txt", 1),
                          Pair("members beside those of the format", 1)));
  EXPECT_FAILS(export_store("store", "out"), StatusCode::kAlreadyExists, "exists");
}

}  // namespace
}  // namespace engram::datasets
