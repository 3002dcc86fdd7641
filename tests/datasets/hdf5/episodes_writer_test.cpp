// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/episodes_writer.h"

#include "tests/datasets/hdf5/hdf5_fixtures.h"

namespace engram::datasets {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

/// Commits one value of an entity at each of some times.
class Writer {
 public:
  explicit Writer(const std::filesystem::path& store) {
    auto recorder = ltm::Recorder::open(store, {});
    ENGRAM_CHECK(recorder.ok(), "{}", recorder.status().to_string());
    recorder_.emplace(*std::move(recorder));
  }

  void add(const char* entity, const std::vector<int>& times_ms,
           const std::function<idf::Data(int)>& value) {
    for (const int time : times_ms) {
      const Time at = time_from_ns(time * 1'000'000ll);
      const Status status = recorder_->commit(
          {{{ltm::MemoryId::parse(entity).value(), at, {{value(time), {.created = at}}}}}});
      ENGRAM_CHECK(status.ok(), "{}", status.to_string());
    }
  }

  Status close() { return recorder_->close(); }

 private:
  std::optional<ltm::Recorder> recorder_;
};

idf::Data numbers(int seed) {
  return idf::Dict{{"values", idf::NdArray::take<float>({2}, {float(seed), 1})}};
}

TEST(EpisodesWriter, ComesBackEqual) {
  const ScratchDirectory scratch;
  ASSERT_OK(testing::write_robomimic(scratch / "a.hdf5", testing::kEnvArgs));
  ASSERT_OK(import_hdf5("robomimic", scratch / "a.hdf5", scratch / "store"));
  const auto exported = export_hdf5("robomimic", scratch / "store", scratch / "b.hdf5");
  ASSERT_OK(exported);
  EXPECT_THAT(exported->not_held, IsEmpty());
  EXPECT_EQ(exported->report.snapshots, 35u);
  EXPECT_EQ(exported->report.files, 1u);
  const auto format = make_robomimic_format();
  const auto first = format->open(scratch / "a.hdf5", {});
  const auto second = format->open(scratch / "b.hdf5", {});
  ASSERT_OK(first);
  ASSERT_OK(second);
  EXPECT_EQ((*first)->streams(), (*second)->streams());
  while (true) {
    const auto a = (*first)->next();
    const auto b = (*second)->next();
    ASSERT_OK(a);
    ASSERT_OK(b);
    ASSERT_EQ(a->has_value(), b->has_value());
    if (!*a) break;
    EXPECT_EQ((*a)->commit, (*b)->commit);
    EXPECT_EQ((*a)->begins.has_value(), (*b)->begins.has_value());
    if ((*a)->begins && (*b)->begins) { EXPECT_EQ((*a)->begins->name, (*b)->begins->name); }
  }
}

TEST(EpisodesWriter, TellsWhatDoesNotFitBeforeItWrites) {
  const ScratchDirectory scratch;
  Writer writer(scratch / "store");
  writer.add("RobotState/Proprioception/robot/joints", {0, 10, 20, 30}, numbers);
  writer.add("Skills/Commands/robot/arm", {0, 10, 20}, numbers);
  writer.add("Data/other/robot/slow", {0, 20}, numbers);
  writer.add("Data/other/robot/list", {0, 10}, [](int) {
    return idf::Dict{{"list", idf::List{1.0}}};
  });
  ASSERT_OK(writer.close());
  const auto exported = export_hdf5("robomimic", scratch / "store", scratch / "a.hdf5");
  ASSERT_OK(exported);
  EXPECT_THAT(exported->not_held, ElementsAre(Pair("lists and members that are absent", 1),
                                              Pair("values that do not come one per step", 1)));
  EXPECT_EQ(exported->report.not_carried, exported->not_held);
  const auto file = h5::File::open(scratch / "a.hdf5");
  ASSERT_OK(file);
  EXPECT_THAT(*file->list("/data/demo_0"), ElementsAre("actions_arm", "obs"));
  EXPECT_EQ(file->array_info("/data/demo_0/obs/joints")->rows(), 4u);
  EXPECT_EQ(file->array_info("/data/demo_0/actions_arm")->rows(), 3u);
}

TEST(EpisodesWriter, ValuesOfSeveralMembersBecomeSeveralArrays) {
  const ScratchDirectory scratch;
  Writer writer(scratch / "store");
  writer.add("RobotState/Localization/robot/base", {0, 20}, [](int time) {
    return idf::Dict{{"pose", idf::Dict{{"position", idf::NdArray::take<double>({3}, {1, 2, 3})}}},
                     {"is_known", true},
                     {"frame", "world"},
                     {"step", int32_t{time}}};
  });
  ASSERT_OK(writer.close());
  ASSERT_OK(export_hdf5("aloha", scratch / "store", scratch / "a.hdf5"));
  const auto file = h5::File::open(scratch / "a.hdf5");
  ASSERT_OK(file);
  const std::string base = "/observations/base";
  EXPECT_THAT(*file->list(base), ElementsAre("frame", "is_known", "pose", "step"));
  EXPECT_EQ(file->array_info(base + "/is_known")->element.kind, h5::Kind::kBool);
  EXPECT_THAT(*file->read_array_texts(base + "/frame", 0, 2), ElementsAre("world", "world"));
  EXPECT_EQ(file->array_info(base + "/pose/position")->shape, (std::vector<uint64_t>{2, 3}));
}

TEST(EpisodesWriter, NothingStaysWhereItFailsOrIsStopped) {
  const ScratchDirectory scratch;
  Writer writer(scratch / "store");
  writer.add("Data/other/robot/grows", {0, 10}, [](int time) {
    return idf::Dict{
        {"values", idf::NdArray::take<float>({time / 10 + 1}, std::vector<float>(time / 10 + 1))}};
  });
  ASSERT_OK(writer.close());
  EXPECT_FAILS(export_hdf5("robomimic", scratch / "store", scratch / "a.hdf5"),
               StatusCode::kInvalidArgument, "is float32 [1], array");
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS(export_hdf5("robomimic", scratch / "store", scratch / "a.hdf5", {}, "@ all",
                           stop.get_token()),
               StatusCode::kCancelled, "stopped");
  EXPECT_FALSE(std::filesystem::exists(scratch / "a.hdf5"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "a.hdf5.part"));
  EXPECT_FAILS(export_hdf5("robomimic", scratch / "store", scratch / "store"),
               StatusCode::kAlreadyExists, "exists");
}

}  // namespace
}  // namespace engram::datasets
