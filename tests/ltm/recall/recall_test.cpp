// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/recall.h"

#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

/// Keeps the bytes of the value as its code; adds "decoded" so that answers tell.
class BytesEncoder final : public Encoder {
 public:
  Result<std::vector<Latent>> encode(std::span<const idf::Data> values) override {
    std::vector<Latent> latents;
    for (const idf::Data& value : values) {
      ENGRAM_ASSIGN_OR_RETURN(auto bytes, idf::encode(value));
      latents.push_back({Buffer::take(std::move(bytes)), {}});
    }
    return latents;
  }

  Result<std::vector<idf::Data>> decode(std::span<const Latent> latents) override {
    std::vector<idf::Data> values;
    for (const Latent& latent : latents) {
      ENGRAM_ASSIGN_OR_RETURN(idf::Data value, idf::decode(latent.code));
      if (idf::Dict* dict = value.get_if<idf::Dict>()) dict->set("decoded", true);
      values.push_back(std::move(value));
    }
    return values;
  }
};

/// Codes four values at a time as one block, and keeps the one that it decoded last.
class BlockEncoder final : public Encoder {
 public:
  explicit BlockEncoder(int* decoded = nullptr) : decoded_(decoded) {}

  Result<std::vector<Latent>> encode(std::span<const idf::Data> values) override {
    std::vector<Latent> latents;
    for (size_t first = 0; first < values.size(); first += kRows) {
      const auto block = values.subspan(first, std::min(kRows, values.size() - first));
      ENGRAM_ASSIGN_OR_RETURN(auto bytes, idf::encode(idf::List(block.begin(), block.end())));
      const Buffer code = Buffer::take(std::move(bytes));
      for (size_t i = 0; i < block.size(); ++i)
        latents.push_back(
            {code, {}, {static_cast<uint32_t>(i), static_cast<uint32_t>(block.size())}});
    }
    return latents;
  }

  Result<std::vector<idf::Data>> decode(std::span<const Latent> latents) override {
    std::vector<idf::Data> values;
    for (const Latent& latent : latents) {
      if (!std::ranges::equal(latent.code.bytes(), last_.bytes())) {
        ENGRAM_ASSIGN_OR_RETURN(const idf::Data block, idf::decode(latent.code));
        last_ = latent.code;
        block_ = block.get<idf::List>();
        ++*decoded_;
      }
      values.push_back(block_[latent.place.index]);
    }
    return values;
  }

 private:
  static constexpr size_t kRows = 4;

  int* decoded_;  ///< Counts blocks.
  Buffer last_;
  idf::List block_;
};

/// Adds the number of steps and the length of the history to the last value.
class CountingPredictor final : public Predictor {
 public:
  explicit CountingPredictor(std::optional<MemoryId> condition = {})
      : condition_(std::move(condition)) {}

  [[nodiscard]] std::string_view name() const override { return "counting"; }
  [[nodiscard]] Duration step() const override { return std::chrono::milliseconds(200); }
  [[nodiscard]] size_t context() const override { return 3; }

  Result<std::vector<Prediction>> predict(const Past& past, int steps) override {
    const auto history = past.values;
    std::vector<Prediction> predictions;
    for (int step = 1; step <= steps; ++step) {
      idf::Data value = history.back();
      value.get_if<idf::Dict>()->set("step", step);
      value.get_if<idf::Dict>()->set("history", static_cast<int32_t>(history.size()));
      if (!past.conditions.empty())
        value.get_if<idf::Dict>()->set("conditions",
                                       idf::List(past.conditions.begin(), past.conditions.end()));
      if (!past.plan.empty())
        value.get_if<idf::Dict>()->set("plan", idf::List(past.plan.begin(), past.plan.end()));
      const double number_mse = past.conditions.empty() ? 0.5 : 0.25;
      predictions.push_back({std::move(value),
                             {{static_cast<double>(step), number_mse},
                              {static_cast<double>(3 * step), 2 * number_mse}}});
    }
    return predictions;
  }

  [[nodiscard]] std::optional<MemoryId> condition() const override { return condition_; }

 private:
  std::optional<MemoryId> condition_;
};

Snapshot snapshot_of(const SnapshotResult& result) {
  Snapshot snapshot{example_entity(), result.time, {}};
  for (const InstanceResult& instance : result.instances)
    snapshot.instances.push_back({instance.data, instance.metadata});
  return snapshot;
}

class RecallTest : public ::testing::Test {
 protected:
  /// Ten recorded snapshots; `latents` of them with latents of model 1; `dropped` without the rest.
  void make_store(int64_t latents, bool is_dropped) {
    store_ = scratch_ / "store";
    ASSERT_OK(create_store(store_));
    {
      const auto writer = *StoreWriter::open(store_, {});
      for (int64_t i = 0; i < 10; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
      ASSERT_OK(writer->append({packed_example(0, example_entity("other"))}, nullptr));
      ASSERT_OK(writer->seal());
    }
    if (latents == 0) return;
    std::vector<LatentSnapshot> snapshots;
    for (int64_t i = 0; i < latents; ++i) {
      const idf::Data value = example_snapshot(example_entity(), i).instances[0].data;
      Latent latent = BytesEncoder().encode({&value, 1})->front();
      snapshots.push_back(
          {example_time(i), 1, {{std::move(latent), example_metadata(i), {2.0, 0.25}}}});
    }
    const auto model = temporary_file(store_, ".model");
    ASSERT_OK(replace_file(*model, as_bytes("weights")));
    ASSERT_OK(publish_model(store_, example_entity(), 1, *model, snapshots));
    if (is_dropped) {
      ASSERT_OK(drop_recorded(store_, example_entity(), {}));
    }
  }

  ModelLoader loader() {
    return [this](const std::filesystem::path& file) -> Result<LoadedModel> {
      ++loaded_;
      EXPECT_TRUE(std::filesystem::exists(file));
      return LoadedModel{std::make_unique<BytesEncoder>(),
                         std::make_unique<CountingPredictor>(condition_)};
    };
  }

  Recall open(ModelLoader loader) { return {*StoreReader::open(store_), std::move(loader)}; }

  static Query ask(const std::string& selector) {
    return *Query::parse("Vision/RGB/head/cam @ " + selector);
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
  int loaded_ = 0;
  std::optional<MemoryId> condition_;  ///< Of the predictor.
};

TEST_F(RecallTest, AnswersWithWhatWasRecorded) {
  make_store(0, false);
  Recall recall = open({});
  const auto result = recall.query(ask("index:3..5"));
  ASSERT_OK(result);
  ASSERT_EQ(result->entities().size(), 1u);
  ASSERT_EQ(result->entities()[0]->snapshots.size(), 3u);
  for (int64_t i = 0; i < 3; ++i) {
    const SnapshotResult& recalled = result->entities()[0]->snapshots[static_cast<size_t>(i)];
    EXPECT_EQ(recalled.source, Source::kRecorded);
    EXPECT_EQ(snapshot_of(recalled), example_snapshot(example_entity(), i + 3));
    EXPECT_EQ(recalled.model, "");
    EXPECT_FALSE(recalled.instances[0].error.has_value());
    EXPECT_FALSE(recalled.instances[0].bound.has_value());
  }
}

TEST_F(RecallTest, TellsAPredictorWhatItsConditionWas) {
  make_store(6, false);
  {
    const auto writer = *StoreWriter::open(store_, {});
    ASSERT_OK(writer->append({packed_example(9, example_entity("late"))}, nullptr));
    ASSERT_OK(writer->seal());
  }
  // Told of each moment is the last value at or before it.
  condition_ = example_entity("other");
  const auto told = open(loader()).query(ask("+200ms"));
  ASSERT_OK(told);
  const InstanceResult& predicted = told->entities()[0]->snapshots[0].instances[0];
  const idf::Data known = example_snapshot(example_entity("other"), 0).instances[0].data;
  const idf::Data* conditions = predicted.data.at("conditions");
  ASSERT_NE(conditions, nullptr);
  EXPECT_EQ(*conditions, idf::Data(idf::List{known, known, known}));
  EXPECT_EQ(predicted.error->number_mse, 0.25);
  // One that begins later than what is predicted from, and one that is not there, are not known.
  for (const char* name : {"late", "nowhere"}) {
    condition_ = example_entity(name);
    const auto untold = open(loader()).query(ask("+200ms"));
    ASSERT_OK(untold);
    const InstanceResult& alone = untold->entities()[0]->snapshots[0].instances[0];
    EXPECT_EQ(alone.data.at("conditions"), nullptr) << name;
    EXPECT_EQ(alone.error->number_mse, 0.5) << name;
  }
}

TEST_F(RecallTest, TellsAPredictorWhatIsPlanned) {
  make_store(6, false);
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (const int64_t i : {10, 12})
      ASSERT_OK(writer->append({packed_example(i, example_entity("plan"))}, nullptr));
    ASSERT_OK(writer->seal());
  }
  condition_ = example_entity("other");
  Recall recall = open(loader());
  const auto planned_at = [](int64_t i) {
    return example_snapshot(example_entity("plan"), i).instances[0].data;
  };
  Recall::Outlook outlook{{}, {std::chrono::milliseconds(400)}, ""};
  outlook.plan = example_entity("plan");
  const auto told = recall.predict(example_entity(), outlook, {});
  ASSERT_OK(told);
  // Of two steps and one more: the last value at or before each moment.
  EXPECT_EQ(told->front().plan, example_entity("plan").to_string());
  ASSERT_NE(told->front().instances[0].data.at("plan"), nullptr);
  EXPECT_EQ(*told->front().instances[0].data.at("plan"),
            idf::Data(idf::List{planned_at(10), planned_at(10), planned_at(12)}));
  // Nothing is planned yet after an earlier moment; then the prediction names no plan.
  outlook.from = example_time(5);
  const auto untold = recall.predict(example_entity(), outlook, {});
  ASSERT_OK(untold);
  EXPECT_EQ(untold->front().plan, "");
  EXPECT_EQ(untold->front().instances[0].data.at("plan"), nullptr);
  // What starts from nothing else cannot follow a plan; a plan that is not there is an error.
  outlook.engine = "copy-last";
  EXPECT_FAILS(recall.predict(example_entity(), outlook, {}), StatusCode::kInvalidArgument,
               "starts from no other entity");
  outlook.engine = "";
  outlook.plan = example_entity("nowhere");
  EXPECT_FAILS(recall.predict(example_entity(), outlook, {}), StatusCode::kNotFound, "nowhere");
}

TEST_F(RecallTest, AnswersForEveryEntityThatMatches) {
  make_store(0, false);
  Recall recall = open({});
  const auto result = recall.query(*Query::parse(".*/.*/.*/.* @ all"));
  ASSERT_OK(result);
  ASSERT_EQ(result->entities().size(), 2u);
  EXPECT_EQ(result->entities()[0]->id, example_entity("cam"));
  EXPECT_EQ(result->entities()[1]->snapshots.size(), 1u);
  EXPECT_TRUE(recall.query(ask("before:5"))->entities()[0]->snapshots.empty());
}

TEST_F(RecallTest, ReconstructsFromLatentsWhatWasDropped) {
  make_store(6, true);
  Recall recall = open(loader());
  const auto result = recall.query(ask("all"));
  ASSERT_OK(result);
  const auto& snapshots = result->entities()[0]->snapshots;
  ASSERT_EQ(snapshots.size(), 10u);
  for (int64_t i = 0; i < 10; ++i) {
    const SnapshotResult& recalled = snapshots[static_cast<size_t>(i)];
    Snapshot expected = example_snapshot(example_entity(), i);
    if (i >= 6) {
      EXPECT_EQ(recalled.source, Source::kRecorded);
    } else {
      EXPECT_EQ(recalled.source, Source::kReconstructed);
      EXPECT_EQ(recalled.model, "Vision/RGB/head/cam v1");
      ASSERT_EQ(recalled.instances.size(), 1u);
      EXPECT_EQ(recalled.instances[0].error->image_mse, 2.0);
      expected.instances[0].data.get_if<idf::Dict>()->set("decoded", true);
    }
    EXPECT_EQ(snapshot_of(recalled), expected);
  }
  EXPECT_EQ(loaded_, 1);
}

TEST_F(RecallTest, PrefersTheFormThatIsAskedFor) {
  make_store(6, false);
  Recall recall = open(loader());
  EXPECT_EQ(recall.query(ask("index:2..2"))->entities()[0]->snapshots[0].source, Source::kRecorded);
  EXPECT_EQ(loaded_, 0);
  const auto latent = recall.query(ask("all"), {.prefer = Recall::Prefer::kLatent});
  ASSERT_OK(latent);
  EXPECT_EQ(latent->entities()[0]->snapshots[5].source, Source::kReconstructed);
  EXPECT_EQ(latent->entities()[0]->snapshots[6].source, Source::kRecorded);
}

TEST_F(RecallTest, DecodesABlockOnceForAllSnapshotsOfAQuery) {
  make_store(0, false);
  std::vector<idf::Data> values;
  for (int64_t i = 0; i < 10; ++i)
    values.push_back(example_snapshot(example_entity(), i).instances[0].data);
  std::vector<LatentSnapshot> snapshots;
  std::vector<Latent> latents = *BlockEncoder().encode(values);
  for (Latent& latent : latents) {
    const auto i = static_cast<int64_t>(snapshots.size());
    snapshots.push_back(
        {example_time(i), 1, {{std::move(latent), example_metadata(i), {2.0, 0.25}}}});
  }
  const auto model = temporary_file(store_, ".model");
  ASSERT_OK(replace_file(*model, as_bytes("weights")));
  ASSERT_OK(publish_model(store_, example_entity(), 1, *model, snapshots));
  ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  for (const auto& [selector, first, count, blocks] : {std::tuple{"all", 0, 10, 3},
                                                       {"index:5..5", 5, 1, 1},
                                                       {"index:2..6", 2, 5, 2},
                                                       {"latest:3", 7, 3, 2}}) {
    int decoded = 0;
    Recall recall = open([&decoded](const std::filesystem::path&) -> Result<LoadedModel> {
      return LoadedModel{std::make_unique<BlockEncoder>(&decoded), nullptr};
    });
    const auto answer = recall.query(ask(selector));
    ASSERT_OK(answer);
    const auto& found = answer->entities()[0]->snapshots;
    ASSERT_EQ(found.size(), static_cast<size_t>(count));
    for (int i = 0; i < count; ++i)
      EXPECT_EQ(snapshot_of(found[static_cast<size_t>(i)]),
                example_snapshot(example_entity(), first + i));
    EXPECT_EQ(decoded, blocks) << selector;
  }
}

TEST_F(RecallTest, NeedsALoaderForLatents) {
  make_store(6, true);
  Recall recall = open({});
  EXPECT_FAILS(recall.query(ask("all")), StatusCode::kFailedPrecondition, "cam v1");
  EXPECT_OK(recall.query(ask("latest")));
}

TEST_F(RecallTest, NamesTheModelThatCannotBeLoaded) {
  make_store(6, true);
  Recall recall = open([](const std::filesystem::path&) -> Result<LoadedModel> {
    return data_loss("broken weights");
  });
  EXPECT_FAILS(recall.query(ask("all")), StatusCode::kDataLoss, "model Vision/RGB/head/cam v1");
}

TEST_F(RecallTest, PredictsWithTheModel) {
  make_store(6, false);
  Recall recall = open(loader());
  const auto result = recall.query(ask("+400ms"));
  ASSERT_OK(result);
  ASSERT_EQ(result->entities()[0]->snapshots.size(), 1u);
  const SnapshotResult& predicted = result->entities()[0]->snapshots[0];
  EXPECT_EQ(predicted.source, Source::kPredicted);
  EXPECT_EQ(predicted.predictor, "counting");
  EXPECT_EQ(predicted.model, "Vision/RGB/head/cam v1");
  EXPECT_EQ(predicted.horizon, std::chrono::milliseconds(400));
  EXPECT_EQ(predicted.time, example_time(11));
  ASSERT_EQ(predicted.instances.size(), 1u);
  EXPECT_EQ(*predicted.instances[0].data.at("step"), idf::Data(2));
  EXPECT_EQ(*predicted.instances[0].data.at("history"), idf::Data(3));
  EXPECT_EQ(*predicted.instances[0].data.at("count"), idf::Data(9));
  EXPECT_EQ(predicted.instances[0].error->image_mse, 2.0);
  EXPECT_EQ(predicted.instances[0].bound->image_mse, 6.0);
  // An explicit time after the last snapshot asks the same.
  const auto at = recall.query(ask("time:" + std::to_string(to_ns(example_time(11)))));
  EXPECT_EQ(at->entities()[0]->snapshots[0], predicted);
  // Times between two steps take the closest, at least one.
  for (const auto& [ahead, step] : {std::pair{"+1ms", 1}, {"+290ms", 1}, {"+310ms", 2}})
    EXPECT_EQ(*recall.query(ask(ahead))->entities()[0]->snapshots[0].instances[0].data.at("step"),
              idf::Data(step));
}

TEST_F(RecallTest, RefusesToPredictTooFarAhead) {
  make_store(6, false);
  Recall recall = open(loader());
  EXPECT_OK(recall.query(ask("+10s")));
  EXPECT_FAILS(recall.query(ask("+10200ms")), StatusCode::kInvalidArgument, "at most 10s");
  EXPECT_FAILS(recall.query(ask("+100000d")), StatusCode::kInvalidArgument, "at most 10s");
  EXPECT_FAILS(recall.query(ask("+800ms"), {.max_steps = 3}), StatusCode::kInvalidArgument,
               "600ms");
}

TEST_F(RecallTest, PredictsByCopyWithoutModels) {
  make_store(0, false);
  Recall recall = open(loader());
  const auto result = recall.query(ask("+2s"));
  ASSERT_OK(result);
  const SnapshotResult& predicted = result->entities()[0]->snapshots[0];
  EXPECT_EQ(predicted.source, Source::kPredicted);
  EXPECT_EQ(predicted.predictor, "copy-last");
  EXPECT_EQ(predicted.model, "");
  EXPECT_EQ(predicted.instances[0].data, example_snapshot(example_entity(), 9).instances[0].data);
  EXPECT_EQ(predicted.time, example_time(19));
  EXPECT_EQ(loaded_, 0);
}

TEST_F(RecallTest, PredictsFromThePastAsIfNothingLaterWereKnown) {
  make_store(6, false);
  Recall recall = open(loader());
  const auto predicted =
      recall.predict(example_entity(),
                     {example_time(4) + std::chrono::milliseconds(1),
                      {std::chrono::milliseconds(400), std::chrono::milliseconds(200)},
                      ""},
                     {});
  ASSERT_OK(predicted);
  ASSERT_EQ(predicted->size(), 2u);
  EXPECT_EQ((*predicted)[0].time, example_time(6));
  EXPECT_EQ((*predicted)[1].time, example_time(5));
  EXPECT_EQ((*predicted)[0].horizon, std::chrono::milliseconds(400));
  const idf::Data& value = (*predicted)[0].instances.at(0).data;
  EXPECT_EQ(*value.at("count"), idf::Data(4)) << "the last one before that moment";
  EXPECT_EQ(*value.at("history"), idf::Data(3));
  EXPECT_EQ(*value.at("step"), idf::Data(2));
  EXPECT_EQ((*predicted)[1].instances.at(0).error->image_mse, 1.0);
  EXPECT_EQ((*predicted)[1].instances.at(0).bound->image_mse, 3.0);
}

TEST_F(RecallTest, PredictsByTheEngineThatIsAskedFor) {
  make_store(6, false);
  Recall recall = open(loader());
  const auto engines = recall.engines(example_entity());
  ASSERT_OK(engines);
  ASSERT_EQ(engines->size(), 2u);
  EXPECT_EQ((*engines)[0].predictor->name(), "counting");
  EXPECT_EQ((*engines)[0].model, "Vision/RGB/head/cam v1");
  EXPECT_EQ((*engines)[1].predictor->name(), "copy-last");
  const auto copied =
      recall.predict(example_entity(), {{}, {std::chrono::milliseconds(400)}, "copy-last"}, {});
  ASSERT_OK(copied);
  EXPECT_EQ(copied->front().predictor, "copy-last");
  EXPECT_EQ(copied->front().instances.at(0).data,
            example_snapshot(example_entity(), 9).instances[0].data);
  EXPECT_FAILS(recall.engine(example_entity(), "oracle"), StatusCode::kNotFound,
               "there is: counting, copy-last");
}

TEST_F(RecallTest, RefusesToPredictFromNothing) {
  make_store(6, false);
  Recall recall = open(loader());
  const std::vector<Duration> next{std::chrono::milliseconds(200)};
  EXPECT_FAILS(recall.predict(example_entity(), {example_time(0) - Duration(1), next, ""}, {}),
               StatusCode::kNotFound, "no snapshot at or before");
  EXPECT_FAILS(recall.predict(example_entity("nowhere"), {{}, next, ""}, {}), StatusCode::kNotFound,
               "nowhere");
  EXPECT_FAILS(recall.predict(example_entity(), {{}, {}, ""}, {}), StatusCode::kInvalidArgument,
               "no horizon");
  for (const Duration impossible : {Duration(-1), Duration::max()})
    EXPECT_FAILS(recall.predict(example_entity(), {{}, {impossible}, "copy-last"}, {}),
                 StatusCode::kInvalidArgument, "needs a moment after");
}

TEST_F(RecallTest, NamesTheEntitiesThatThereAre) {
  make_store(0, false);
  Recall recall = open({});
  EXPECT_FAILS(recall.query(*Query::parse("Vision/RGB/head/none")), StatusCode::kNotFound,
               "it has: Vision/RGB/head/cam, Vision/RGB/head/other");
}

TEST_F(RecallTest, UnitesSeveralSelectors) {
  make_store(0, false);
  Recall recall = open({});
  const auto result = recall.query(ask("latest:2, +400ms, 0..1, 1..2"));
  ASSERT_OK(result);
  const auto& snapshots = result->entities()[0]->snapshots;
  ASSERT_EQ(snapshots.size(), 6u);
  for (const auto& [place, index] : {std::pair{0, 0}, {1, 1}, {2, 2}, {3, 8}, {4, 9}, {5, 11}})
    EXPECT_EQ(snapshots[static_cast<size_t>(place)].time, example_time(index));
  EXPECT_EQ(snapshots[5].source, Source::kPredicted);
}

TEST_F(RecallTest, UnitesBranchesWithSelectorsOfTheirOwn) {
  make_store(0, false);
  Recall recall = open({});
  const auto result =
      recall.query(*Query::parse("Vision/RGB/.*/cam @ 3..4 ; Vision/RGB/head/.* @ 0..0"));
  ASSERT_OK(result);
  ASSERT_EQ(result->entities().size(), 2u);
  EXPECT_EQ(result->entities()[0]->snapshots.size(), 3u);
  EXPECT_EQ(result->entities()[1]->snapshots.size(), 1u);
}

TEST_F(RecallTest, AnswersWithTheInstancesThatAreAskedFor) {
  make_store(0, false);
  Recall recall = open({});
  EXPECT_EQ(recall.query(ask("all#0"))->snapshot_count(), 10u);
  EXPECT_EQ(recall.query(ask("all#1"))->snapshot_count(), 0u);
  const auto result = recall.query(ask("0..3#1, 2..2#0"));
  ASSERT_EQ(result->snapshot_count(), 1u);
  EXPECT_EQ(result->ids()[0], example_entity().at(example_time(2)).instance(0));
}

TEST_F(RecallTest, NamesIdsWithoutDecoding) {
  make_store(6, true);
  Recall recall = open({});
  const auto result = recall.query(*Query::parse("?ids Vision/RGB/head/cam @ all, +1s"));
  ASSERT_OK(result);
  EXPECT_TRUE(result->is_ids_only());
  EXPECT_EQ(result->size_bytes(), 0u);
  const auto& snapshots = result->entities()[0]->snapshots;
  ASSERT_EQ(snapshots.size(), 11u);
  EXPECT_EQ(snapshots[0].source, Source::kReconstructed);
  EXPECT_EQ(snapshots[9].source, Source::kRecorded);
  EXPECT_EQ(snapshots[10].source, Source::kPredicted);
  EXPECT_EQ(result->ids()[3], example_entity().at(example_time(3)).instance(0));
  for (const SnapshotResult& snapshot : snapshots) {
    ASSERT_EQ(snapshot.instances.size(), 1u);
    EXPECT_EQ(snapshot.instances[0].data, idf::Data());
  }
}

TEST_F(RecallTest, NamesInstancesThatAreStillInTheJournal) {
  store_ = scratch_ / "store";
  ASSERT_OK(create_store(store_));
  const auto writer = *StoreWriter::open(store_, {});
  ASSERT_OK(writer->append({packed_example(0)}, nullptr));
  Recall recall = open({});
  EXPECT_EQ(recall.query(*Query::parse("?ids Vision"))->ids(),
            std::vector<MemoryId>{example_entity().at(example_time(0)).instance(0)});
}

}  // namespace
}  // namespace engram::ltm
