// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "reports/choice_text.h"
#include "reports/contact_sheet.h"
#include "reports/costs_text.h"
#include "reports/forms_text.h"
#include "reports/predict_text.h"
#include "tests/datasets/fixtures.h"

namespace engram::reports {
namespace {

using datasets::testing::TemporaryDirectory;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

idf::NdArray image(int64_t height, int64_t width, uint8_t value) {
  const auto bytes = static_cast<size_t>(3 * height * width);
  return idf::NdArray::take({height, width, 3}, std::vector<uint8_t>(bytes, value));
}

TEST(PredictText, ReadsHorizonsInStepsAndInTime) {
  const Duration step = milliseconds(200);
  EXPECT_THAT(*parse_horizons("1..3", step),
              ElementsAre(milliseconds(200), milliseconds(400), milliseconds(600)));
  EXPECT_THAT(*parse_horizons("2", step), ElementsAre(milliseconds(400)));
  EXPECT_THAT(*parse_horizons("+100ms,+1s", step), ElementsAre(milliseconds(100), seconds(1)));
  for (const char* wrong : {"", "0", "3..1", "1..2000", "two", "+", "1..3,x"})
    EXPECT_EQ(parse_horizons(wrong, step).status().code(), StatusCode::kInvalidArgument) << wrong;
}

TEST(FormsText, TellsWhatWasKeptAndWhatEachFormAloneWouldTake) {
  encoders::StoredForms forms;
  EXPECT_TRUE(forms_json(forms).is_null());
  forms.rows = 400;
  forms.latent_rows = 300;
  forms.video_rows = 100;
  forms.kept_bytes = 400'000;
  forms.latent_kept_bytes = 240'000;
  forms.video_kept_bytes = 160'000;
  forms.video_bytes = 800'000;
  forms.bound_db = 34;
  forms.noise_images = 32;
  EXPECT_EQ(kept_text(forms), "300 latents, 800 B each; 100 video, 1.6 kB each");
  EXPECT_THAT(
      forms_text(forms),
      ElementsAre("1.0 kB each: 300 latents, 800 B each; 100 video, 1.6 kB each",
                  "bound 34.0 dB, from the noise of 32 images", "each form alone: video 2.0 kB"));
  EXPECT_EQ(forms_json(forms)["video_rows"], 100);
}

TEST(ChoiceText, ComparesModelsOnlyWhereThereWasOneBefore) {
  encoders::ModelChoice choice;
  EXPECT_EQ(choice_text(choice), "");
  EXPECT_TRUE(choice_json(choice).is_null());
  choice.previous_version = 1;
  choice.snapshots = 30;
  choice.new_snapshots = 10;
  choice.nights = 2;
  choice.previous = {2000, 1000, 0};
  choice.made = {1000, 500, 500};
  EXPECT_THAT(choice_text(choice), HasSubstr("20 known"));
  EXPECT_THAT(choice_text(choice), HasSubstr("2 nights"));
  const Json json = choice_json(choice);
  EXPECT_EQ(json["previous_model"]["total_bytes"], 4000);
  EXPECT_EQ(json["new_model"]["total_bytes"], 2500);
  EXPECT_EQ(json["keeps_previous_model"], false);
}

TEST(CostsText, TellsWhereTheTimeWent) {
  training::EntityCosts costs;
  EXPECT_THAT(costs_text(costs), ElementsAre());
  EXPECT_TRUE(encodes_json(costs).is_null());
  training::StageTime now;
  costs.stages = training::StageTimes([&now] { return now; });
  const auto spend = [&](training::Stage stage, double processor_seconds) {
    const training::StageTimes::Scope scope(&costs.stages, stage);
    now.processor_seconds += processor_seconds;
    now.seconds += processor_seconds / 2;
  };
  spend(training::Stage::kVideo, 60);
  spend(training::Stage::kTraining, 19.9);
  spend(training::Stage::kOther, 0.1);
  EXPECT_THAT(costs_text(costs), ElementsAre("processor time 80.0 s: training 25 %, video 75 %"));
  EXPECT_EQ(stages_json(costs.stages)["video"]["processor_seconds"], 60.0);
  EXPECT_EQ(stages_json(costs.stages)["video"]["seconds"], 30.0);
  EXPECT_EQ(stages_json(costs.stages)["plan"]["seconds"], 0.0);

  costs.images_encoded = 1200;
  costs.video = "av1:effort=6";
  EXPECT_EQ(costs_text(costs)[1], "1,200 images encoded");
  EXPECT_TRUE(encodes_json(costs)["mean_per_search"].is_null());
  costs.encodes = {8, 2, 3, 1};
  EXPECT_EQ(costs_text(costs)[1],
            "1,200 images encoded; 3.5 encodes a chain as av1:effort=6, 2.5 in the median");
  EXPECT_EQ(encodes_json(costs)["mean_per_search"], 3.5);
  EXPECT_EQ(encodes_json(costs)["median_per_search"], 2.5);
  costs.known_videos = 1200;
  EXPECT_THAT(costs_text(costs)[1], HasSubstr("; 1,200 videos were known"));
}

TEST(Picture, FindsTheFirstImageOfAValue) {
  const idf::Data value = idf::Dict{{"name", "cup"}, {"image", image(16, 24, 9)}};
  const idf::NdArray* found = first_image(value);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->shape(), (idf::Shape{16, 24, 3}));
  EXPECT_EQ(first_image(idf::Data(1.0)), nullptr);
}

TEST(Picture, AmplifiesWhereImagesDiffer) {
  const idf::NdArray shown = difference(image(2, 2, 10), image(2, 2, 13));
  EXPECT_EQ(shown, image(2, 2, 3 * kDifferenceGain));
}

TEST(Picture, WritesAllImagesOfASheetAndRefusesThoseOfSeveralSizes) {
  const TemporaryDirectory directory;
  const auto path = directory / "sheet.png";
  ASSERT_TRUE(write_contact_sheet(path, {{"recorded", {image(64, 64, 200), image(64, 64, 50)}}},
                                  {"first", "second"})
                  .ok());
  const cv::Mat sheet = cv::imread(path.string());
  EXPECT_GE(sheet.rows, 64);
  EXPECT_GE(sheet.cols, 128);
  const Status status = write_contact_sheet(
      directory / "b.png", {{"recorded", {image(64, 64, 200), image(32, 64, 50)}}}, {"a", "b"});
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(write_contact_sheet(directory / "c.png", {}, {}).code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::reports
