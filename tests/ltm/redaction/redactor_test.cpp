// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/redactor.h"

#include <gmock/gmock.h>

#include "ltm/redaction/redaction_config.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

using idf::NdArray;
using testing::grey_images_with_secret;
using testing::has_secret;
using ::testing::HasSubstr;
using testing::image_with_secret;
using ::testing::IsEmpty;
using testing::marker_redaction;

MemoryId entity(const std::string& text = "Vision/RGB/head/cam") {
  return *MemoryId::parse(text);
}

class RedactorTest : public ::testing::Test {
 protected:
  void open(RedactionOptions options, const std::string& pattern = "Vision") {
    auto made = Redactor::create({{*EntityPattern::parse(pattern), std::move(options)}});
    ASSERT_OK(made);
    redactor_ = *std::move(made);
  }
  static Snapshot snapshot(idf::Data data, int64_t at_ms = 0) {
    return {entity(), time_from_ns(1'000'000'000'000 + at_ms * 1'000'000), {{std::move(data), {}}}};
  }
  static const NdArray& image_of(const Snapshot& snapshot, std::string_view path = "") {
    return snapshot.instances[0].data.at(path)->get<NdArray>();
  }
  /// The pixel of an image, without its channels.
  static uint8_t red(const NdArray& image, int x, int y) {
    return image.values<uint8_t>()[static_cast<size_t>((y * image.shape()[1] + x) * 3)];
  }

  ScratchDirectory scratch_;
  std::unique_ptr<Redactor> redactor_;
};

TEST_F(RedactorTest, TakesOutWhatIsFoundAndNothingElse) {
  for (const RedactAction action : {RedactAction::kPixelate, RedactAction::kFill}) {
    RedactionOptions options = marker_redaction(scratch_.path());
    options.action = action;
    open(options);
    const NdArray given = image_with_secret(64, 48, 20, 10);
    Snapshot with = snapshot(given);
    const RedactionOutcome outcome = redactor_->redact(with);
    EXPECT_FALSE(outcome.is_dropped());
    EXPECT_EQ(outcome.redacted, 1u);
    EXPECT_EQ(outcome.boxes, 1u);
    EXPECT_FALSE(has_secret(image_of(with)));
    EXPECT_EQ(red(image_of(with), 19, 10), 90);
    EXPECT_EQ(red(image_of(with), 36, 10), 90);
    EXPECT_EQ(red(image_of(with), 20, 10) == 0, action == RedactAction::kFill);
    // The buffer that others share is as it was.
    EXPECT_TRUE(has_secret(given));
    ASSERT_EQ(outcome.originals.size(), 1u);
    EXPECT_EQ(outcome.originals[0].data(), given.buffer().data());
    Snapshot without = snapshot(image_with_secret(64, 48, -1, 0));
    const std::byte* const before = image_of(without).buffer().data();
    EXPECT_EQ(redactor_->redact(without).redacted, 0u);
    EXPECT_EQ(image_of(without).buffer().data(), before);
  }
}

TEST_F(RedactorTest, LeavesEntitiesAloneThatNoRuleNames) {
  open(marker_redaction(scratch_.path()), "Vision/RGB/head/other");
  Snapshot one = snapshot(image_with_secret(64, 48, 20, 10));
  EXPECT_EQ(redactor_->redact(one).redacted, 0u);
  EXPECT_TRUE(has_secret(image_of(one)));
  EXPECT_FALSE(redactor_->applies_to(entity()));
  EXPECT_TRUE(redactor_->may_apply_in("Vision"));
  EXPECT_FALSE(redactor_->may_apply_in("Robot"));
}

TEST_F(RedactorTest, GrowsBoxesAndCutsThemAtTheImage) {
  RedactionOptions options = marker_redaction(scratch_.path());
  options.grow = 0.5;
  options.action = RedactAction::kFill;
  open(options);
  Snapshot one = snapshot(image_with_secret(64, 48, 20, 10));
  redactor_->redact(one);
  EXPECT_EQ(red(image_of(one), 12, 2), 0);
  EXPECT_EQ(red(image_of(one), 11, 2), 90);
  EXPECT_EQ(red(image_of(one), 43, 33), 0);
  EXPECT_EQ(red(image_of(one), 44, 33), 90);
  Snapshot corner = snapshot(image_with_secret(64, 48, 48, 32));
  redactor_->redact(corner);
  EXPECT_FALSE(has_secret(image_of(corner)));
  EXPECT_EQ(red(image_of(corner), 63, 47), 0);
}

TEST_F(RedactorTest, SurvivesBoxesFarOutside) {
  RedactionOptions options = marker_redaction(scratch_.path(), "outside");
  options.action = RedactAction::kFill;
  options.grow = 10;
  open(options);
  Snapshot one = snapshot(image_with_secret(64, 48, 20, 10));
  EXPECT_FALSE(redactor_->redact(one).is_dropped());
  EXPECT_EQ(red(image_of(one), 0, 0), 0);
}

TEST_F(RedactorTest, HoldsABoxUntilItIsLongGone) {
  RedactionOptions options = marker_redaction(scratch_.path());
  options.hold = std::chrono::seconds(1);
  options.action = RedactAction::kFill;
  open(options);
  Snapshot seen = snapshot(image_with_secret(64, 48, 20, 10), 0);
  redactor_->redact(seen);
  const auto is_filled = [&](int64_t at_ms, const std::string& name = "Vision/RGB/head/cam") {
    Snapshot later = snapshot(image_with_secret(64, 48, -1, 0), at_ms);
    later.entity = entity(name);
    redactor_->redact(later);
    return red(image_of(later), 25, 15) == 0;
  };
  EXPECT_TRUE(is_filled(500));
  EXPECT_FALSE(is_filled(500, "Vision/RGB/head/other"));
  // Late ones, and those of a clock that was set back.
  EXPECT_TRUE(is_filled(-900));
  EXPECT_FALSE(is_filled(-1100));
  EXPECT_TRUE(is_filled(1000));
  EXPECT_FALSE(is_filled(1001));
  EXPECT_TRUE(is_filled(900)) << "one that comes late";
}

TEST_F(RedactorTest, HoldsABoxThoughOneSnapshotHasATimeFarAhead) {
  RedactionOptions options = marker_redaction(scratch_.path());
  options.hold = std::chrono::seconds(1);
  options.action = RedactAction::kFill;
  open(options);
  Snapshot seen = snapshot(image_with_secret(64, 48, 20, 10), 0);
  redactor_->redact(seen);
  Snapshot ahead = snapshot(image_with_secret(64, 48, -1, 0), 3'600'000);
  EXPECT_EQ(redactor_->redact(ahead).redacted, 0u);
  Snapshot next = snapshot(image_with_secret(64, 48, -1, 0), 100);
  EXPECT_EQ(redactor_->redact(next).redacted, 1u);
  EXPECT_EQ(red(image_of(next), 25, 15), 0);
}

TEST_F(RedactorTest, HoldsABoxThoughTheSizeOfImagesChanges) {
  RedactionOptions options = marker_redaction(scratch_.path());
  options.hold = std::chrono::seconds(1);
  options.action = RedactAction::kFill;
  open(options);
  Snapshot seen = snapshot(image_with_secret(64, 48, 20, 10), 0);
  redactor_->redact(seen);
  Snapshot large = snapshot(image_with_secret(128, 96, -1, 0), 100);
  redactor_->redact(large);
  EXPECT_EQ(red(image_of(large), 40, 20), 0);
  EXPECT_EQ(red(image_of(large), 71, 51), 0);
  EXPECT_EQ(red(image_of(large), 72, 52), 90);
}

TEST_F(RedactorTest, LooksAtOneAnswerAloneIfItIsTold) {
  RedactionOptions options = marker_redaction(scratch_.path());
  options.hold = std::chrono::hours(1);
  open(options);
  Snapshot seen = snapshot(image_with_secret(64, 48, 20, 10), 0);
  EXPECT_EQ(redactor_->redact(seen, RedactionMemory::kNone).redacted, 1u);
  Snapshot next = snapshot(image_with_secret(64, 48, -1, 0), 1);
  EXPECT_EQ(redactor_->redact(next, RedactionMemory::kHold).redacted, 0u);
}

TEST_F(RedactorTest, FindsImagesInsideAndLetsDepthFollowColour) {
  RedactionOptions options = marker_redaction(scratch_.path());
  options.action = RedactAction::kFill;
  open(options);
  std::vector<float> depth(64 * 48, 2.0f);
  Snapshot one = snapshot(
      idf::Dict{{"rgbd", idf::List{idf::Dict{{"rgb", image_with_secret(64, 48, 20, 10)},
                                             {"depth", NdArray::take({48, 64, 1}, depth)}}}},
                {"small", image_with_secret(32, 24, -1, 0)},
                {"pose", NdArray::take({4, 4}, std::vector<double>(16, 1.0))}});
  const RedactionOutcome outcome = redactor_->redact(one);
  EXPECT_EQ(outcome.redacted, 2u);
  EXPECT_FALSE(has_secret(image_of(one, "rgbd/0/rgb")));
  const auto depths = image_of(one, "rgbd/0/depth").values<float>();
  EXPECT_EQ(depths[15 * 64 + 25], 0.0f);
  EXPECT_EQ(depths[15 * 64 + 5], 2.0f);
  EXPECT_EQ(image_of(one, "pose").values<double>()[0], 1.0);
}

TEST_F(RedactorTest, LooksAtEveryChannelAndEveryAxis) {
  open(marker_redaction(scratch_.path()));
  for (const idf::Shape& shape :
       {idf::Shape{2, 48, 64}, {4, 48, 64}, {9, 48, 64}, {1, 1, 9, 48, 64}}) {
    const int64_t count = shape.size() == 3 ? shape[0] : 9;
    const NdArray given = grey_images_with_secret<float>(static_cast<int>(count), 64, 48, 20, 10);
    Snapshot one = snapshot(*NdArray::create(given.type(), shape, given.buffer()));
    EXPECT_EQ(redactor_->redact(one).boxes, 1u) << count;
    const size_t in_last = static_cast<size_t>(((count - 1) * 48 + 10) * 64 + 20);
    EXPECT_EQ(given.values<float>()[in_last], 255.0f);
    EXPECT_NE(image_of(one).values<float>()[in_last], 255.0f) << count;
  }
  // A channel of which nothing is used is not worth a look.
  Snapshot plain = snapshot(NdArray::take({48, 64, 4}, std::vector<uint8_t>(48 * 64 * 4, 255)));
  EXPECT_EQ(redactor_->redact(plain).redacted, 0u);
}

TEST_F(RedactorTest, DropsASnapshotOfMoreImagesThanItLooksAt) {
  open(marker_redaction(scratch_.path()));
  const auto images = [&](int64_t count) {
    return snapshot(NdArray::take({count, 8, 8, 1}, std::vector<uint8_t>(count * 64)));
  };
  Snapshot many = images(256);
  EXPECT_FALSE(redactor_->redact(many).is_dropped());
  Snapshot more = images(257);
  const RedactionOutcome outcome = redactor_->redact(more);
  EXPECT_TRUE(outcome.is_unreadable);
  EXPECT_EQ(outcome.dropped, "found more than 256 images in one snapshot");
  more = images(200);
  more.instances.push_back(images(200).instances[0]);
  EXPECT_TRUE(redactor_->redact(more).is_dropped());
  EXPECT_EQ(redactor_->counters().unreadable, 2u);
  EXPECT_EQ(redactor_->counters().images, 256u);
}

TEST_F(RedactorTest, LooksAtEveryInstance) {
  open(marker_redaction(scratch_.path()));
  Snapshot one = snapshot(image_with_secret(64, 48, -1, 0));
  one.instances.push_back({image_with_secret(64, 48, 3, 3), {}});
  EXPECT_EQ(redactor_->redact(one).redacted, 1u);
  EXPECT_FALSE(has_secret(one.instances[1].data.get<NdArray>()));
}

TEST_F(RedactorTest, DropsASnapshotIfThatIsTheAction) {
  RedactionOptions options = marker_redaction(scratch_.path());
  options.action = RedactAction::kDrop;
  open(options);
  Snapshot with = snapshot(image_with_secret(64, 48, 20, 10));
  Snapshot without = snapshot(image_with_secret(64, 48, -1, 0));
  EXPECT_THAT(redactor_->redact(with).dropped, HasSubstr("found something"));
  EXPECT_FALSE(redactor_->redact(without).is_dropped());
  EXPECT_EQ(redactor_->counters().dropped, 1u);
  EXPECT_EQ(redactor_->counters().unanswered, 0u);
}

TEST_F(RedactorTest, DropsAndCountsWhatHasNoAnswerOrCannotBeRead) {
  open(marker_redaction(scratch_.path(), "silent"));
  Snapshot with = snapshot(image_with_secret(64, 48, 20, 10));
  const RedactionOutcome outcome = redactor_->redact(with);
  EXPECT_TRUE(outcome.is_unanswered);
  EXPECT_THAT(outcome.dropped, HasSubstr("no answer in time"));
  Snapshot next = snapshot(image_with_secret(64, 48, -1, 0));
  EXPECT_THAT(redactor_->redact(next).dropped, HasSubstr("not ready"));
  std::vector<uint8_t> jpeg(500);
  jpeg[0] = 0xFF, jpeg[1] = 0xD8, jpeg[2] = 0xFF;
  Snapshot encoded = snapshot(idf::Dict{{"data", NdArray::take({500}, jpeg)}});
  EXPECT_THAT(redactor_->redact(encoded).dropped, HasSubstr("'data' is a file of an image"));
  Snapshot numbers = snapshot(idf::Dict{{"x", 1.0}});
  EXPECT_FALSE(redactor_->redact(numbers).is_dropped());
  EXPECT_EQ(redactor_->counters().unanswered, 2u);
  EXPECT_EQ(redactor_->counters().unreadable, 1u);
  EXPECT_EQ(redactor_->counters().dropped, 3u);
}

TEST_F(RedactorTest, IsAnErrorWhereADetectorCannotBeOpened) {
  RedactionOptions options;
  options.detector = OnnxDetector::Options{scratch_.path() / "none.onnx"};
  const auto made = Redactor::create({{*EntityPattern::parse("Vision"), options}});
  EXPECT_EQ(made.status().code(), StatusCode::kNotFound);
  EXPECT_THAT(made.status().message(), HasSubstr("redact 'Vision'"));
}

Result<RedactionOptions> read(const std::string& yaml) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue value, ConfigValue::parse(yaml, "r.yaml"));
  return read_redaction(value);
}

TEST(RedactionConfig, ReadsEveryOption) {
  const auto people = read("{detector: people}");
  ASSERT_OK(people);
  EXPECT_EQ(*people, RedactionOptions());
  EXPECT_EQ(people->grow, 0.2);
  EXPECT_EQ(people->hold, std::chrono::seconds(1));
  const auto program =
      read("{detector: {program: [./find, -v]}, action: fill, grow: 0, hold: 0s, timeout: 300ms}");
  ASSERT_OK(program);
  const auto& command = std::get<ProgramDetector::Options>(program->detector);
  EXPECT_THAT(command.command, ::testing::ElementsAre("./find", "-v"));
  EXPECT_EQ(command.timeout, std::chrono::milliseconds(300));
  EXPECT_EQ(program->action, RedactAction::kFill);
  EXPECT_EQ(program->grow, 0);
  EXPECT_EQ(program->hold, Duration(0));
  const auto onnx = read("{detector: {onnx: a.onnx, threshold: 0.4, classes: [0, 2], size: 320}}");
  ASSERT_OK(onnx);
  EXPECT_EQ(std::get<OnnxDetector::Options>(onnx->detector),
            (OnnxDetector::Options{"a.onnx", 0.4, {0, 2}, 320}));
  EXPECT_EQ(std::get<FacesDetector::Options>(read("{detector: {faces: f.xml}}")->detector).cascade,
            "f.xml");
  EXPECT_OK(parse_detector("people", "--detector"));
  EXPECT_OK(parse_detector("{program: [./find]}", "--detector"));
}

TEST(RedactionConfig, RefusesWhatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"{}", "detector"},
      {"{detector: peple}", "found detector 'peple'"},
      {"{detector: {people: 1}}", "needs people, faces"},
      {"{detector: {onnx: a, program: [b]}}", "needs people, faces"},
      {"{detector: {onnx: a, treshold: 0.5}}", "did you mean 'threshold'"},
      {"{detector: {onnx: a, threshold: 2}}", "needs 0 to 1"},
      {"{detector: {onnx: a, size: 9}}", "needs 32 to"},
      {"{detector: {onnx: a, classes: [-1]}}", "number of a class"},
      {"{detector: {program: []}}", "needs a program"},
      {"{detector: {program: x}}", "list"},
      {"{detector: people, action: blur}", "needs one of pixelate, fill, drop"},
      {"{detector: people, grow: -1}", "grow: found -1"},
      {"{detector: people, grow: 11}", "grow: found 11"},
      {"{detector: people, hold: 5}", "hold"},
      {"{detector: people, hold: 2d}", "needs 0s to 1d"},
      {"{detector: people, timeout: 1s}", "is for programs"},
      {"{detector: {program: [a]}, timeout: 0s}", "timeout"},
      {"{detector: people, growth: 1}", "growth"}};
  for (const auto& [yaml, says] : wrong) {
    const auto options = read(yaml);
    EXPECT_EQ(options.status().code(), StatusCode::kInvalidArgument) << yaml;
    EXPECT_THAT(options.status().message(), HasSubstr(says)) << yaml;
    EXPECT_THAT(options.status().message(), HasSubstr("r.yaml:1")) << yaml;
  }
}

}  // namespace
}  // namespace engram::ltm
