// SPDX-License-Identifier: Apache-2.0
// What Recall answers about the future.
#include "ltm/recall/joined_past.h"
#include "tests/ltm/recall/recalled_store.h"

namespace engram::ltm {
namespace {

class RecallPrediction : public RecalledStore {};

TEST_F(RecallPrediction, TellsAPredictorWhatItsConditionWas) {
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

TEST_F(RecallPrediction, TellsAPredictorWhatIsPlanned) {
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
  Recall::PredictionRequest request{{}, {std::chrono::milliseconds(400)}, ""};
  request.plan = example_entity("plan");
  const auto told = recall.predict(example_entity(), request, {});
  ASSERT_OK(told);
  // Of two steps and one more: the last value at or before each moment.
  EXPECT_EQ(told->front().plan, example_entity("plan").to_string());
  ASSERT_NE(told->front().instances[0].data.at("plan"), nullptr);
  EXPECT_EQ(*told->front().instances[0].data.at("plan"),
            idf::Data(idf::List{planned_at(10), planned_at(10), planned_at(12)}));
  // Nothing is planned yet after an earlier moment; then the prediction names no plan.
  request.from = example_time(5);
  const auto untold = recall.predict(example_entity(), request, {});
  ASSERT_OK(untold);
  EXPECT_EQ(untold->front().plan, "");
  EXPECT_EQ(untold->front().instances[0].data.at("plan"), nullptr);
  // What starts from nothing else cannot follow a plan; a plan that is not there is an error.
  request.engine = "copy-last";
  EXPECT_FAILS(recall.predict(example_entity(), request, {}), StatusCode::kInvalidArgument,
               "starts from no other entity");
  request.engine = "";
  request.plan = example_entity("nowhere");
  EXPECT_FAILS(recall.predict(example_entity(), request, {}), StatusCode::kNotFound, "nowhere");
}

TEST_F(RecallPrediction, PredictsWithTheModel) {
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

TEST_F(RecallPrediction, RefusesToPredictTooFarAhead) {
  make_store(6, false);
  Recall recall = open(loader());
  EXPECT_OK(recall.query(ask("+60s")));
  EXPECT_FAILS(recall.query(ask("+60200ms")), StatusCode::kInvalidArgument, "at most 1min");
  EXPECT_FAILS(recall.query(ask("+100000d")), StatusCode::kInvalidArgument, "at most 1min");
  const Recall::Options near{.max_horizon = std::chrono::milliseconds(600)};
  EXPECT_OK(recall.query(ask("+600ms"), near));
  EXPECT_FAILS(recall.query(ask("+800ms"), near), StatusCode::kInvalidArgument, "600ms");
}

/// A server lives longer than a model.
TEST_F(RecallPrediction, PredictsByAModelThatIsPublishedMeanwhile) {
  make_store(6, false);
  const auto memory = *WorkingMemory::create({.mode = StoreMode::kLatest});
  RecordedEntities recorded;
  auto joined =
      JoinedPast::create("server", *memory, *StorePast::open(store_, loader(), {}), recorded);
  Recall recall(std::move(joined));
  const auto model = [&] {
    const auto answer =
        recall.predict(example_entity(), {{}, {std::chrono::milliseconds(200)}, "counting"}, {});
    return answer.ok() ? answer->front().model : answer.status().to_string();
  };
  EXPECT_EQ(model(), "Vision/RGB/head/cam v1");
  const auto file = temporary_file(store_, ".model");
  ASSERT_OK(replace_file(*file, as_bytes("more weights")));
  const idf::Data value = example_snapshot(example_entity(), 9).instances[0].data;
  LatentSnapshot latent{example_time(9), 2, {}};
  latent.instances.push_back(
      {BytesEncoder().encode({&value, 1})->front(), example_metadata(9), {2.0, 0.25}});
  ASSERT_OK(publish_model(store_, example_entity(), 2, *file, {latent}));
  EXPECT_EQ(model(), "Vision/RGB/head/cam v2");
}

TEST_F(RecallPrediction, PredictsByCopyWithoutModels) {
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

TEST_F(RecallPrediction, PredictsFromThePastAsIfNothingLaterWereKnown) {
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

TEST_F(RecallPrediction, PredictsByTheEngineThatIsAskedFor) {
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

TEST_F(RecallPrediction, RefusesToPredictFromNothing) {
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

}  // namespace
}  // namespace engram::ltm
