// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/recall.h"

#include "tests/ltm/recall/recalled_store.h"

namespace engram::ltm {
namespace {

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

Snapshot snapshot_of(const SnapshotResult& result) {
  Snapshot snapshot{example_entity(), result.time, {}};
  for (const InstanceResult& instance : result.instances)
    snapshot.instances.push_back({instance.data, instance.metadata});
  return snapshot;
}

class RecallTest : public RecalledStore {};

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

TEST_F(RecallTest, AnswersWithoutADamagedModelWhereThatCan) {
  make_store(6, false);
  int tried = 0;
  StorePast past(*StoreReader::open(store_), [&tried](const auto&) -> Result<LoadedModel> {
    ++tried;
    return data_loss("it is damaged");
  });
  const auto entity = *past.of(example_entity());
  for (int64_t i = 0; i < 10; ++i) {
    const auto read = entity->read(example_time(i), Prefer::kLatent);
    ASSERT_OK(read);
    EXPECT_EQ(read->answer.source, Source::kRecorded);
    EXPECT_EQ(snapshot_of(read->answer), example_snapshot(example_entity(), i));
  }
  const auto models = past.models(example_entity());
  ASSERT_OK(models);
  EXPECT_TRUE(models->empty());
  EXPECT_EQ(tried, 1);
  EXPECT_EQ(past.counters().damaged_models, 1u);
  EXPECT_EQ(past.counters().substituted, 6u);

  Recall recall = open([](const auto&) -> Result<LoadedModel> { return data_loss("is damaged"); });
  const auto ahead = recall.query(ask("+200ms"));
  ASSERT_OK(ahead);
  EXPECT_EQ(ahead->entities()[0]->snapshots[0].predictor, "copy-last");
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
