// SPDX-License-Identifier: Apache-2.0
#include "training/fit/trainer.h"

#include <gtest/gtest.h>

#include "encoders/load_model.h"
#include "encoders/model_file.h"
#include "ltm/core/file.h"
#include "tests/training/moving_scene.h"
#include "training/fit/network_width.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::content_of;
using engram::testing::quick_options;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

/// Mean squared errors of all values of a source after encoding and decoding.
ltm::MeasuredError reconstruction_error(const TrainingSource& source, ltm::Encoder& encoder) {
  ltm::MeasuredError sum{0, 0};
  for (size_t i = 0; i < source.times.size(); ++i) {
    const idf::Data value = *source.read(i);
    const auto decoded = encoder.decode(*encoder.encode({&value, 1}));
    const auto error = compare(value, decoded->front());
    sum.image_mse += error->image_mse / static_cast<double>(source.times.size());
    sum.number_mse += error->number_mse / static_cast<double>(source.times.size());
  }
  return sum;
}

TEST(Trainer, OverfitsOneBatch) {
  const ScratchPath before("one_step"), after("overfit");
  const auto source = scene_source(8, 1, true, false);
  auto options = quick_options(2);
  const auto first = train_model(source, options, before.path(), {}, {});
  options.steps = 700;
  const auto last = train_model(source, options, after.path(), {}, {});
  ASSERT_TRUE(first.ok()) << first.status().to_string();
  ASSERT_TRUE(last.ok()) << last.status().to_string();
  EXPECT_GT(last->training_psnr_db, first->training_psnr_db + 6);
  auto model = encoders::load_model(after.path());
  ASSERT_TRUE(model.ok()) << model.status().to_string();
  const double psnr = psnr_db(reconstruction_error(source, *model->encoder).image_mse);
  EXPECT_GT(psnr, 31.0);
  RecordProperty("psnr_db", std::to_string(psnr));
}

TEST(Trainer, WritesTheSameModelForTheSameSeedAndSteps) {
  const ScratchPath a("seed_a"), b("seed_b"), c("seed_c");
  const auto source = scene_source(24);
  auto options = quick_options(20);
  ASSERT_TRUE(train_model(source, options, a.path(), {}, {}).ok());
  ASSERT_TRUE(train_model(source, options, b.path(), {}, {}).ok());
  options.seed = 2;
  ASSERT_TRUE(train_model(source, options, c.path(), {}, {}).ok());
  EXPECT_GT(content_of(a.path()).size(), 10000u);
  EXPECT_TRUE(content_of(a.path()) == content_of(b.path()));
  EXPECT_FALSE(content_of(a.path()) == content_of(c.path()));
}

class TrainerOfVariant : public ::testing::TestWithParam<encoders::TrainingVariant> {};

TEST_P(TrainerOfVariant, OverfitsOneBatch) {
  const ScratchPath before("variant_start"), after("variant_overfit");
  const auto source = scene_source(8, 1, true, false);
  auto options = quick_options(2);
  options.variant = GetParam();
  ASSERT_TRUE(train_model(source, options, before.path(), {}, {}).ok());
  options.steps = 400;
  ASSERT_TRUE(train_model(source, options, after.path(), {}, {}).ok());
  auto first = encoders::load_model(before.path());
  auto last = encoders::load_model(after.path());
  ASSERT_TRUE(first.ok()) << first.status().to_string();
  ASSERT_TRUE(last.ok()) << last.status().to_string();
  const double start = reconstruction_error(source, *first->encoder).image_mse;
  const double end = reconstruction_error(source, *last->encoder).image_mse;
  EXPECT_LT(end, 0.3 * start);
  EXPECT_EQ(encoders::read_provenance(after.path())->variant, GetParam());
}

TEST_P(TrainerOfVariant, WritesTheSameModelForTheSameSeedAndSteps) {
  const ScratchPath a("variant_a"), b("variant_b"), rate("variant_rate");
  const auto source = scene_source(24);
  auto options = quick_options(10);
  ASSERT_TRUE(train_model(source, options, rate.path(), {}, {}).ok());
  options.variant = GetParam();
  ASSERT_TRUE(train_model(source, options, a.path(), {}, {}).ok());
  ASSERT_TRUE(train_model(source, options, b.path(), {}, {}).ok());
  EXPECT_TRUE(content_of(a.path()) == content_of(b.path()));
  EXPECT_EQ(content_of(a.path()) == content_of(rate.path()),
            GetParam() == encoders::TrainingVariant::kRateAware);
}

INSTANTIATE_TEST_SUITE_P(Variants, TrainerOfVariant,
                         ::testing::ValuesIn(encoders::kTrainingVariants),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

TEST(Trainer, KeepsNumbersWithinTheBoundThatWasAskedFor) {
  const ScratchPath file("numbers");
  const auto source = scene_source(64, 1, false, true);
  for (const double bound : {0.05, 0.001}) {
    std::filesystem::remove(file.path());
    auto options = quick_options(20);
    options.number_bound = bound;
    ASSERT_TRUE(train_model(source, options, file.path(), {}, {}).ok());
    auto model = encoders::load_model(file.path());
    ASSERT_TRUE(model.ok()) << model.status().to_string();
    std::vector<idf::Data> values;
    for (size_t i = 0; i < source.times.size(); ++i) values.push_back(*source.read(i));
    const auto decoded = model->encoder->decode(*model->encoder->encode(values));
    ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
    double largest = 0;
    for (size_t i = 0; i < values.size(); ++i)
      largest = std::max(largest, std::abs(values[i].at("load")->get<double>() -
                                           (*decoded)[i].at("load")->get<double>()));
    EXPECT_LE(largest, bound);
    EXPECT_GT(largest, bound / 10);
  }
}

TEST(Trainer, PredictsNotWorseThanCopyLastOnTheHeldOutPart) {
  const ScratchPath file("predict");
  const auto source = scene_source(60, 2);
  ASSERT_TRUE(train_model(source, quick_options(400), file.path(), {}, {}).ok());
  auto model = encoders::load_model(file.path());
  ASSERT_TRUE(model.ok()) << model.status().to_string();
  ltm::MeasuredError deep{0, 0}, copied{0, 0};
  for (const size_t last : {24, 25, 26, 27, 28, 54, 55, 56, 57, 58}) {
    const std::vector<idf::Data> history{*source.read(last - 1), *source.read(last)};
    const idf::Data truth = *source.read(last + 1);
    const auto predicted = model->predictor->predict(history, 1);
    ASSERT_TRUE(predicted.ok()) << predicted.status().to_string();
    // Moments that are asked for alone are those of a whole rollout, bit for bit.
    const auto whole = model->predictor->predict(history, 4);
    const auto alone = model->predictor->predict_at(history, std::vector<int>{4, 1});
    ASSERT_TRUE(whole.ok() && alone.ok());
    EXPECT_EQ(alone->front().value, whole->back().value);
    EXPECT_EQ(alone->back().value, predicted->front().value);
    const auto error = compare(truth, predicted->front().value);
    const auto copy_error = compare(truth, history.back());
    deep.image_mse += error->image_mse;
    deep.number_mse += error->number_mse;
    copied.image_mse += copy_error->image_mse;
    copied.number_mse += copy_error->number_mse;
  }
  EXPECT_LE(deep.image_mse, copied.image_mse * 1.001);
  EXPECT_LE(deep.number_mse, copied.number_mse * 1.001);
  EXPECT_EQ(model->predictor->step(), std::chrono::milliseconds(200));
  const auto records = model->predictor->records(ltm::PredictorInputs::kConditions);
  ASSERT_EQ(records.size(), 5u);
  EXPECT_LT(records.front().mean.number_mse, records.back().mean.number_mse);
}

TEST(Trainer, EndsMotionAfterAFewPasses) {
  const ScratchPath file("passes");
  const auto report =
      train_model(scene_source(24, 1, true, false), quick_options(2200), file.path(), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  // 8 % of the steps are of the dynamics, 20 % are there for motion: 400 are enough here.
  EXPECT_NEAR(static_cast<double>(report->dynamics_steps), 176 + 400, 1);
}

/// Two recordings, the second one in negative, so that there are views to vary.
TrainingSource two_scenes() {
  TrainingSource source = scene_source(48, 2, true, false);
  source.read = [read = source.read](size_t i) -> Result<idf::Data> {
    ENGRAM_ASSIGN_OR_RETURN(idf::Data value, read(i));
    if (i < 24) return value;
    const auto* image = value.at("image")->get_if<idf::NdArray>();
    std::vector<uint8_t> pixels;
    for (const uint8_t pixel : image->values<uint8_t>()) pixels.push_back(255 - pixel);
    value.get_if<idf::Dict>()->set("image",
                                   idf::NdArray::take<uint8_t>(image->shape(), std::move(pixels)));
    return value;
  };
  return source;
}

TEST(Trainer, KnowsRecordedViewsBetterThanVariedOnes) {
  const auto told = [](double varied_share) {
    const ScratchPath file("varied");
    auto options = quick_options(400);
    options.varied_share = varied_share;
    const auto report = train_model(two_scenes(), options, file.path(), {}, {});
    EXPECT_TRUE(report.ok()) << report.status().to_string();
    return report->training_psnr_db;
  };
  EXPECT_GT(told(0), told(1) + 1);
}

/// An image as bright as chance has it, which another entity knows one snapshot earlier.
TrainingSource announced_source(int count) {
  const auto level_of = [](size_t i) { return static_cast<int>(i * 2654435761U % 97); };
  TrainingSource source = scene_source(count, 1, true, false);
  source.read = [=](size_t i) -> Result<idf::Data> {
    idf::Dict dict;
    dict.set("image",
             idf::NdArray::take<uint8_t>(
                 {16, 16, 1}, std::vector<uint8_t>(256, static_cast<uint8_t>(80 + level_of(i)))));
    return idf::Data(std::move(dict));
  };
  source.condition_entity = "Test/Scene/sim/announcement";
  source.read_condition = [=](size_t i) -> Result<std::optional<idf::Data>> {
    idf::Dict dict;
    dict.set("next", static_cast<double>(level_of(i + 1)));
    return std::optional(idf::Data(std::move(dict)));
  };
  return source;
}

TEST(Trainer, PredictsFromWhatAnotherEntityKnows) {
  const ScratchPath file("condition");
  const TrainingSource source = announced_source(80);
  ASSERT_TRUE(train_model(source, quick_options(3000), file.path(), {}, {}).ok());
  auto model = encoders::load_model(file.path());
  ASSERT_TRUE(model.ok()) << model.status().to_string();
  ltm::Predictor& predictor = *model->predictor;
  ASSERT_TRUE(predictor.condition().has_value());
  EXPECT_EQ(predictor.condition()->to_string(), "Test/Scene/sim/announcement");
  EXPECT_LT(predictor.records(ltm::PredictorInputs::kConditions).at(0).mean.image_mse,
            predictor.records(ltm::PredictorInputs::kValues).at(0).mean.image_mse / 2);
  const std::vector<idf::Data> history{*source.read(70), *source.read(71)};
  const std::vector<idf::Data> conditions{**source.read_condition(70), **source.read_condition(71)};
  const idf::Data truth = *source.read(72);
  const auto told = predictor.predict({history, conditions}, 1);
  const auto untold = predictor.predict(history, 1);
  ASSERT_TRUE(told.ok()) << told.status().to_string();
  ASSERT_TRUE(untold.ok()) << untold.status().to_string();
  EXPECT_LT(compare(truth, told->front().value)->image_mse,
            compare(truth, untold->front().value)->image_mse);
  EXPECT_LT(told->front().error.expected.image_mse, untold->front().error.expected.image_mse);
  // With a plan, errors are those that were measured with plans.
  EXPECT_LT(predictor.records(ltm::PredictorInputs::kPlan).at(1).mean.image_mse,
            predictor.records(ltm::PredictorInputs::kValues).at(1).mean.image_mse / 2);
  const std::vector<idf::Data> plan{**source.read_condition(72), **source.read_condition(73)};
  ltm::Past planned{history, conditions};
  planned.plan = plan;
  const auto followed = predictor.predict(planned, 2);
  ASSERT_TRUE(followed.ok()) << followed.status().to_string();
  const auto unplanned = predictor.predict({history, conditions}, 2);
  ASSERT_TRUE(unplanned.ok()) << unplanned.status().to_string();
  EXPECT_FALSE((*followed)[1].value == (*unplanned)[1].value);
  // A plan stands still beyond its end.
  planned.plan = std::span(plan).first(1);
  const std::vector<idf::Data> still{plan[0], plan[0], plan[0]};
  const auto ended = predictor.predict(planned, 2);
  planned.plan = still;
  const auto stood = predictor.predict(planned, 2);
  ASSERT_TRUE(ended.ok() && stood.ok());
  EXPECT_TRUE((*ended)[1].value == (*stood)[1].value);
  // Without the past of what is planned it tells nothing; of another layout it is refused.
  planned.conditions = {};
  EXPECT_TRUE(predictor.predict(planned, 1)->front().value == untold->front().value);
  const std::vector<idf::Data> unlike{idf::Data(1.0)};
  planned = {history, conditions};
  planned.plan = unlike;
  EXPECT_EQ(predictor.predict(planned, 1).status().code(), StatusCode::kInvalidArgument);
  // Values of another layout count as not known.
  const std::vector<idf::Data> others{idf::Data(1.0), idf::Data(2.0)};
  const auto misled = predictor.predict({history, others}, 1);
  ASSERT_TRUE(misled.ok()) << misled.status().to_string();
  EXPECT_TRUE(misled->front().value == untold->front().value);
}

TEST(Trainer, LeavesWholeRecordingsOut) {
  const ScratchPath file("left_out");
  const auto source = scene_source(60, 3);
  auto options = quick_options(4);
  options.hold_out_recordings = 1;
  const auto report = train_model(source, options, file.path(), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->used_snapshots, 40u);
  const auto provenance = encoders::read_provenance(file.path());
  ASSERT_TRUE(provenance.ok());
  for (const auto& span : provenance->autoencoder_spans)
    EXPECT_FALSE(span.contains(source.times[45]));
  options.hold_out_recordings = 3;
  EXPECT_EQ(train_model(source, options, file.path(), {}, {}).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(Trainer, SamplesEvenlyWhatDoesNotFitIntoMemoryAndSaysSo) {
  const ScratchPath file("sampled");
  auto options = quick_options(4);
  options.memory_bytes = 100 * (40 * 48 * 3 + 24);
  const auto source = scene_source(200);
  const auto report = train_model(source, options, file.path(), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_LE(report->used_snapshots, 110u);
  EXPECT_GE(report->used_snapshots, 80u);
  EXPECT_EQ(report->sequences, 1u);
  EXPECT_EQ(report->notes.size(), 1u);
  // What lies between is seconds from what was trained on and does not count as never seen.
  const auto provenance = encoders::read_provenance(file.path());
  ASSERT_TRUE(provenance.ok());
  ASSERT_EQ(provenance->autoencoder_spans.size(), 1u);
  EXPECT_TRUE(provenance->autoencoder_spans[0].contains(source.times.front()));
  EXPECT_TRUE(provenance->autoencoder_spans[0].contains(source.times.back()));
  ASSERT_EQ(provenance->dynamics_spans.size(), 1u);
  EXPECT_TRUE(provenance->dynamics_spans[0].contains(source.times[169]));
  EXPECT_FALSE(provenance->dynamics_spans[0].contains(source.times[170]));
}

TEST(Trainer, StopsWhenAsked) {
  const ScratchPath file("stopped");
  std::stop_source stop;
  const ProgressSink sink = [&](const Progress& progress) {
    if (progress.done >= 3) stop.request_stop();
  };
  const auto report =
      train_model(scene_source(24), quick_options(100000), file.path(), sink, stop.get_token());
  EXPECT_EQ(report.status().code(), StatusCode::kCancelled);
  EXPECT_FALSE(std::filesystem::exists(file.path()));
}

TEST(Trainer, KeepsAConstantValueExactly) {
  const ScratchPath file("constant");
  auto source = scene_source(20, 1, false, true);
  idf::Dict dict;
  dict.set("time", int64_t{1'700'000'000'123'456});
  dict.set("x", 0.1);
  source.read = [=](size_t) -> Result<idf::Data> { return idf::Data(dict); };
  ASSERT_TRUE(train_model(source, quick_options(10), file.path(), {}, {}).ok());
  auto model = encoders::load_model(file.path());
  ASSERT_TRUE(model.ok()) << model.status().to_string();
  EXPECT_EQ(reconstruction_error(source, *model->encoder).number_mse, 0.0);
}

TEST(Trainer, ChoosesTheWidestNetworksThatTakeAFifthOfWhatTheySave) {
  const auto layout = idf::Layout::of(engram::testing::scene_at(0));
  TrainOptions options;
  const auto bytes = [&](int width) {
    options.width = width;
    return static_cast<double>(network_bytes(layout, options));
  };
  EXPECT_EQ(width_that_pays(layout, options, 5 * bytes(32) - 1), 0);
  for (const int width : {32, 48, 64, 96, 128})
    EXPECT_EQ(width_that_pays(layout, options, 5 * bytes(width)), width);
  EXPECT_EQ(width_that_pays(layout, options, 5 * bytes(64) - 1), 48);
  const auto numbers = idf::Layout::of(engram::testing::scene_at(0, false, true));
  EXPECT_EQ(width_that_pays(numbers, options, 1e12), 0);
}

TEST(Trainer, RejectsOptionsThatCannotBe) {
  TrainOptions options;
  options.psnr_db = 0;
  EXPECT_EQ(options.validate().code(), StatusCode::kInvalidArgument);
  options = {};
  options.steps = 0;
  EXPECT_EQ(options.validate().code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(TrainOptions().validate().ok());
}

}  // namespace
}  // namespace engram::training
