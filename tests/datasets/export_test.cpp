// SPDX-License-Identifier: Apache-2.0
#include "datasets/export.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "datasets/media/video_reader.h"
#include "ltm/codec/png.h"
#include "ltm/core/file.h"
#include "ltm/idf/json.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::datasets {
namespace {

using Json = nlohmann::ordered_json;
using ltm::example_image;
using ltm::example_time;
using testing::ElementsAre;
using testing::HasSubstr;

/// Everything below a directory, as paths relative to it.
std::set<std::string> files_below(const std::filesystem::path& directory) {
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory))
    if (entry.is_regular_file()) files.insert(entry.path().lexically_relative(directory).string());
  return files;
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class ExportTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_OK(ltm::create_store(store_)); }

  void store(const ltm::MemoryId& entity, int64_t index, const std::vector<idf::Data>& values) {
    ltm::Snapshot snapshot{entity, example_time(index), {}};
    for (const idf::Data& value : values)
      snapshot.instances.push_back({value, ltm::example_metadata(index)});
    auto writer = ltm::StoreWriter::open(store_, {});
    ASSERT_OK(writer);
    ASSERT_OK((*writer)->append({ltm::pack_snapshot(snapshot)}, nullptr));
  }

  Result<ExportReport> write(std::string_view format, const std::string& query = "@ all",
                             const ExportOptions& options = {}, const std::stop_token& stop = {}) {
    ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(store_));
    ltm::Recall recall(std::move(reader), {});
    ENGRAM_RETURN_IF_ERROR(prepare_export(out_, false));
    ENGRAM_ASSIGN_OR_RETURN(const auto sink, make_snapshot_sink(format, out_, options));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query parsed, ltm::Query::parse(query));
    ENGRAM_RETURN_IF_ERROR(export_snapshots(recall, parsed, {}, *sink, {}, stop));
    return sink->report();
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_ = scratch_ / "store";
  std::filesystem::path out_ = scratch_ / "out";
  const ltm::MemoryId cam_ = ltm::example_entity();
};

idf::Data camera_value(int64_t seed) {
  return idf::Dict{{"image", example_image(16, 24, 3, seed)},
                   {"gain", 0.5 * static_cast<double>(seed)},
                   {"label", "frame " + std::to_string(seed)}};
}

// What every format keeps to.
class EveryFormat : public ExportTest, public testing::WithParamInterface<std::string_view> {};

TEST_P(EveryFormat, WritesNothingOfAnEmptyStore) {
  const auto report = write(GetParam());
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 0u);
  EXPECT_EQ(report->bytes, 0u);
}

TEST_P(EveryFormat, CountsSnapshotsInstancesFilesAndBytes) {
  for (int64_t i = 0; i < 4; ++i) store(cam_, i, {camera_value(i), camera_value(i + 10)});
  for (int64_t i = 0; i < 3; ++i) store(ltm::example_entity("other"), i, {camera_value(i)});
  const auto report = write(GetParam());
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 7u);
  EXPECT_EQ(report->instances, 11u);
  const auto files = files_below(out_);
  uint64_t bytes = 0;
  for (const std::string& file : files) bytes += std::filesystem::file_size(out_ / file);
  EXPECT_EQ(report->files, files.size());
  EXPECT_EQ(report->bytes, bytes);
  EXPECT_GT(bytes, 0u);
}

TEST_P(EveryFormat, StaysInsideOfItsDirectoryWhateverTheNames) {
  const std::vector<std::string> names{"..",
                                       ".",
                                       "a/b",
                                       "/etc",
                                       "new\nline",
                                       "tab\t",
                                       "%2F",
                                       "#",
                                       "\\",
                                       std::string(400, 'x'),
                                       std::string(400, 'x') + "y",
                                       "\xc3\xa4\xf0\x9f\xa4\x96",
                                       " ",
                                       "con.csv"};
  for (const std::string& name : names)
    store(*ltm::MemoryId::from_names({"M", "..", name, name}), 0,
          {idf::Dict{{name, example_image(16, 24, 3, 1)}, {"n", 1.0}}});
  const auto report = write(GetParam());
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, names.size());
  EXPECT_EQ(report->files, files_below(out_).size()) << "two names share a file";
  EXPECT_GE(report->files, GetParam() == "jsonl" ? 1 : names.size());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch_.path()), {}), 2);
}

TEST_P(EveryFormat, TakesLayoutsThatChangeAndValuesOfEveryKind) {
  const std::vector<idf::Data> values{
      camera_value(1),
      idf::Data(),
      idf::Data(7),
      idf::Data("text"),
      idf::Data("\xff\xfe"),
      idf::List{1, 2.0, "three"},
      example_image(16, 24, 1, 2),
      example_image(9, 11, 3, 3),
      idf::NdArray::take({8, 8, 1}, std::vector<uint16_t>(64, 40000)),
      idf::NdArray::take({3}, std::vector<float>{1, 2, 3}),
      idf::NdArray(),
      idf::Dict{{"a", idf::Dict{{"b", example_image(16, 24, 3, 4)}, {"$c", int64_t{1}}}}},
      idf::Dict{}};
  for (size_t i = 0; i < values.size(); ++i) store(cam_, static_cast<int64_t>(i), {values[i]});
  const auto report = write(GetParam());
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, values.size());
  for (const std::string& file : files_below(out_)) EXPECT_FALSE(file.ends_with(".part"));
}

TEST_P(EveryFormat, LeavesWholeFilesWhereItIsStopped) {
  for (int64_t i = 0; i < 4; ++i) store(cam_, i, {camera_value(i)});
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS(write(GetParam(), "@ all", {}, stop.get_token()), StatusCode::kCancelled, "whole");
  for (const std::string& file : files_below(out_)) EXPECT_FALSE(file.ends_with(".part"));
}

TEST_P(EveryFormat, RefusesADirectoryWithFiles) {
  std::filesystem::create_directory(out_);
  std::ofstream(out_ / "mine") << "keep";
  EXPECT_FAILS(write(GetParam()), StatusCode::kAlreadyExists, "not empty");
  EXPECT_OK(prepare_export(out_, true));
  EXPECT_FAILS(prepare_export(out_ / "mine", true), StatusCode::kAlreadyExists, "is a file");
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat, testing::ValuesIn(kExportFormats),
                         [](const auto& format) { return std::string(format.param); });

TEST_F(ExportTest, JsonLinesReadBackToTheIdenticalValues) {
  for (int64_t i = 0; i < 3; ++i) store(cam_, i, {camera_value(i)});
  ASSERT_OK(write("jsonl"));
  const auto lines = lines_of(out_ / "snapshots.jsonl");
  ASSERT_EQ(lines.size(), 3u);
  for (int64_t i = 0; i < 3; ++i) {
    const Json json = Json::parse(lines[static_cast<size_t>(i)]);
    EXPECT_EQ(json["id"], cam_.at(example_time(i)).to_string());
    EXPECT_EQ(json["time_ns"], to_ns(example_time(i)));
    EXPECT_EQ(json["source"], "recorded");
    const Json& instance = json["instances"].at(0);
    EXPECT_EQ(instance["provider"], "camera driver");
    const auto data = idf::from_json(instance["data"]);
    ASSERT_OK(data);
    EXPECT_EQ(*data, camera_value(i));
  }
}

TEST_F(ExportTest, CsvHasAColumnPerNumberAndATablePerSetOfColumns) {
  store(cam_, 0, {idf::Dict{{"x", 0.25}, {"a,b", true}, {"label", "text"}}});
  store(cam_, 1, {idf::Dict{{"p", idf::NdArray::take({2}, std::vector<float>{1.5, -2})}}});
  store(cam_, 2, {idf::Dict{{"x", std::nan("")}, {"a,b", false}, {"label", "text"}}});
  const auto report = write("csv");
  ASSERT_OK(report);
  EXPECT_THAT(files_below(out_),
              ElementsAre("Vision/RGB/head/cam#2.csv", "Vision/RGB/head/cam.csv"));
  EXPECT_THAT(lines_of(out_ / "Vision/RGB/head/cam.csv"),
              ElementsAre("time_ns,time,instance,source,x,\"a,b\"",
                          "1600000000000000000,2020-09-13T12:26:40.000000Z,0,recorded,0.25,1",
                          "1600000000400000000,2020-09-13T12:26:40.400000Z,0,recorded,nan,0"));
  EXPECT_THAT(lines_of(out_ / "Vision/RGB/head/cam#2.csv"),
              ElementsAre("time_ns,time,instance,source,p[0],p[1]",
                          "1600000000200000000,2020-09-13T12:26:40.200000Z,0,recorded,1.5,-2"));
  EXPECT_THAT(report->not_carried, ElementsAre(testing::Pair("texts", 2u)));
}

TEST_F(ExportTest, PngFilesHoldTheIdenticalPixels) {
  store(cam_, 0, {camera_value(1), camera_value(2)});
  const auto report = write("png");
  ASSERT_OK(report);
  EXPECT_THAT(files_below(out_),
              ElementsAre("Vision/RGB/head/cam/image/2020-09-13T12-26-40.000000#1.png",
                          "Vision/RGB/head/cam/image/2020-09-13T12-26-40.000000.png"));
  const auto png = read_file(out_ / *files_below(out_).rbegin());
  const auto image = ltm::png_codec().decode(png->bytes(), idf::ElementType::kUInt8, {16, 24, 3});
  ASSERT_OK(image);
  EXPECT_EQ(*image, example_image(16, 24, 3, 1));
  EXPECT_THAT(report->not_carried,
              ElementsAre(testing::Pair("numbers", 2u), testing::Pair("texts", 2u)));
}

TEST_F(ExportTest, ArmarxFoldersHoldImagesAndAllElseAsJson) {
  store(cam_, 5, {idf::Dict{{"left", idf::Dict{{"rgb", example_image(16, 24, 3, 1)}}}, {"n", 2}}});
  const auto report = write("armarx");
  ASSERT_OK(report);
  const std::string folder = "Vision/RGB/head/cam/1600000001000000/0/";
  EXPECT_THAT(files_below(out_), ElementsAre(folder + "data.json", folder + "left.rgb.png"));
  const Json json = Json::parse(std::ifstream(out_ / (folder + "data.json")));
  EXPECT_EQ(json["data"]["left"]["rgb"]["$file"], "left.rgb.png");
  EXPECT_EQ(json["data"]["n"]["$int32"], 2);
  EXPECT_EQ(json["time_ns"], to_ns(example_time(5)));
  EXPECT_THAT(report->not_carried, testing::IsEmpty());
}

TEST_F(ExportTest, AnImageThatIsTheValueItselfIsNamedValue) {
  store(cam_, 5, {example_image(16, 24, 3, 1)});
  ASSERT_OK(write("armarx"));
  const std::string folder = "Vision/RGB/head/cam/1600000001000000/0/";
  EXPECT_THAT(files_below(out_), ElementsAre(folder + "data.json", folder + "value.png"));
  const Json json = Json::parse(std::ifstream(out_ / (folder + "data.json")));
  EXPECT_EQ(json["data"]["$file"], "value.png");
}

TEST_F(ExportTest, CountsTextsThatAreNoUtf8AsNotCarried) {
  store(cam_, 0, {idf::Dict{{"text", "\xff"}}});
  const auto report = write("jsonl");
  ASSERT_OK(report);
  EXPECT_THAT(report->not_carried, ElementsAre(testing::Pair(HasSubstr("no UTF-8"), 1u)));
  EXPECT_TRUE(
      Json::parse(lines_of(out_ / "snapshots.jsonl").at(0))["instances"][0]["data"].is_null());
}

TEST_F(ExportTest, Mp4HasTheTimesOfTheSnapshotsAndBeginsAnewAfterAGap) {
  for (const int64_t i : {0, 1, 4, 20'000, 20'001}) store(cam_, i, {camera_value(3)});
  ASSERT_OK(write("mp4"));
  EXPECT_THAT(files_below(out_),
              ElementsAre("Vision/RGB/head/cam/image.mp4", "Vision/RGB/head/cam/image.part2.mp4"));
  auto video = VideoReader::open(out_ / "Vision/RGB/head/cam/image.mp4", {});
  ASSERT_OK(video);
  std::vector<int64_t> times_ms;
  while (true) {
    const auto frame = video->next();
    ASSERT_OK(frame);
    if (!*frame) break;
    times_ms.push_back(std::chrono::round<std::chrono::milliseconds>((*frame)->time).count());
  }
  EXPECT_THAT(times_ms, ElementsAre(0, 200, 800));
}

TEST_F(ExportTest, Mp4OpensNoMoreThan32Encoders) {
  idf::Dict many;
  for (int i = 0; i < 34; ++i) many.set("image" + std::to_string(i), example_image(16, 16, 3, i));
  store(cam_, 0, {many});
  const auto report = write("mp4");
  ASSERT_OK(report);
  EXPECT_EQ(report->files, 32u);
  EXPECT_THAT(report->not_carried, ElementsAre(testing::Pair(HasSubstr("beside 32"), 2u)));
}

TEST_F(ExportTest, AQuerySaysWhichSnapshotsAndInstances) {
  for (int64_t i = 0; i < 10; ++i) store(cam_, i, {camera_value(i), camera_value(-i)});
  store(ltm::example_entity("other"), 0, {camera_value(0)});
  const auto report = write("jsonl", "Vision/RGB/head/cam @ 0..3#1, 2..4#1, -1..-1");
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 6u);
  EXPECT_EQ(report->instances, 7u);
  std::filesystem::remove_all(out_);
  EXPECT_FAILS(write("jsonl", "Vision/RGB/none"), StatusCode::kNotFound, "no entity matches");
  EXPECT_FAILS(write("pdf"), StatusCode::kInvalidArgument, "pdf");
}

}  // namespace
}  // namespace engram::datasets
