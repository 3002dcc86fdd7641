// SPDX-License-Identifier: Apache-2.0
// What a store answers about the future where it knows the engines of this room.
#include "ltm/prediction/entity_predictor.h"
#include "ltm/prediction/series_engine.h"
#include "tests/ltm/recall/recalled_store.h"

namespace engram::ltm {
namespace {

using std::chrono::milliseconds;

class RecallChoice : public RecalledStore {
 protected:
  Recall open_choice(ModelLoader loader = {}) {
    return {*StoreReader::open(store_), std::move(loader), nullptr, make_entity_predictor};
  }

  void add(int64_t first, int64_t last) {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = first; i < last; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
    ASSERT_OK(writer->seal());
  }
};

TEST_F(RecallChoice, AnswersByTheBestEngine) {
  make_store(0, false);
  add(10, 100);
  Recall recall = open_choice();
  const auto answer = recall.query(ask("+400ms, +1s"));
  ASSERT_OK(answer);
  const auto& snapshots = answer->entities()[0]->snapshots;
  ASSERT_EQ(snapshots.size(), 2u);
  EXPECT_NE(snapshots[0].predictor, "copy-last");
  EXPECT_EQ(snapshots[0].horizon, milliseconds(400));
  EXPECT_NEAR(snapshots[0].instances[0].data.at("x")->get<double>(), 0.25 * 101, 1e-9);
  EXPECT_EQ(*snapshots[1].instances[0].data.at("count"), idf::Data(104));
  EXPECT_EQ(*snapshots[1].instances[0].data.at("label"), idf::Data("number 99"));
  EXPECT_NEAR(snapshots[1].instances[0].error->number_mse, 0, 1e-9);
  EXPECT_EQ(snapshots[1].instances[0].metadata.provider, "camera driver");
}

TEST_F(RecallChoice, PredictsFromThePastAsIfNothingLaterWereKnown) {
  make_store(0, false);
  add(10, 40);
  Recall recall = open_choice();
  // To and fro: what was learned later must not tell.
  for (const int64_t from : {30, 31, 35, 20, 39}) {
    const auto predicted =
        recall.predict(example_entity(), {example_time(from), {milliseconds(200)}, "line"}, {});
    ASSERT_OK(predicted);
    EXPECT_EQ(*predicted->front().instances[0].data.at("count"),
              idf::Data(static_cast<int32_t>(from + 1)));
    const auto records =
        recall.records(example_entity(), example_time(from), milliseconds(200), {});
    ASSERT_OK(records);
    EXPECT_EQ(records->front().predictions, static_cast<uint64_t>(from + 1 - (from + 1) * 2 / 3));
  }
  EXPECT_FAILS(
      recall.predict(example_entity(), {example_time(0) - Duration(1), {milliseconds(1)}, ""}, {}),
      StatusCode::kNotFound, "no snapshot at or before");
  EXPECT_FAILS(recall.predict(example_entity(), {{}, {milliseconds(1)}, "oracle"}, {}),
               StatusCode::kNotFound, "there is: ");
}

TEST_F(RecallChoice, MeasuresTheModelBesideTheOthers) {
  make_store(6, false);
  add(10, 60);
  // Its predictions have members more than the values: nothing can be measured of it.
  Recall recall = open_choice(loader());
  const auto records = recall.records(example_entity(), {}, milliseconds(200), {});
  ASSERT_OK(records);
  ASSERT_EQ(records->size(), make_series_engines().size() + 1);
  EXPECT_EQ(records->back().engine, "counting");
  EXPECT_EQ(records->back().predictions, 0u);
  const auto named = recall.predict(example_entity(), {{}, {milliseconds(400)}, "counting"}, {});
  ASSERT_OK(named);
  EXPECT_EQ(named->front().model, "Vision/RGB/head/cam v1");
  EXPECT_EQ(*named->front().instances[0].data.at("step"), idf::Data(2));
  EXPECT_EQ(*named->front().instances[0].data.at("history"), idf::Data(3));
  EXPECT_FAILS(recall.query(ask("+61s")), StatusCode::kInvalidArgument, "at most 1min");
}

TEST_F(RecallChoice, TellsTheModelWhatItsConditionWas) {
  make_store(6, false);
  condition_ = example_entity("other");
  Recall recall = open_choice(loader());
  const auto told = recall.predict(example_entity(), {{}, {milliseconds(200)}, "counting"}, {});
  ASSERT_OK(told);
  ASSERT_NE(told->front().instances[0].data.at("conditions"), nullptr);
  condition_ = example_entity("nowhere");
  Recall untold = open_choice(loader());
  const auto alone = untold.predict(example_entity(), {{}, {milliseconds(200)}, "counting"}, {});
  ASSERT_OK(alone);
  EXPECT_EQ(alone->front().instances[0].data.at("conditions"), nullptr);
  // A plan is told to the model alone.
  Recall::PredictionRequest planned{{}, {milliseconds(200)}, ""};
  planned.plan = example_entity("nowhere");
  EXPECT_FAILS(recall.predict(example_entity(), planned, {}), StatusCode::kNotFound, "nowhere");
}

}  // namespace
}  // namespace engram::ltm
