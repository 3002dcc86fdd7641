// SPDX-License-Identifier: Apache-2.0
// What is particular to single detectors.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "ltm/redaction/detector_registry.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/ltm/redaction/onnx_file.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

using testing::bright_cells_onnx;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::image_with_secret;
using testing::marker_program;

DetectorImage seen(const idf::NdArray& array) {
  const auto pixels = array.values<uint8_t>();
  return {static_cast<int>(array.shape()[1]),
          static_cast<int>(array.shape()[0]),
          static_cast<int>(array.shape()[2]),
          pixels,
          "A/b/c/d",
          "rgb",
          time_from_ns(5)};
}

TEST(Boxes, AreReadFromAnAnswer) {
  EXPECT_THAT(*parse_boxes(R"({"image": 7, "boxes": [[1, 2.5, 3, 4], [-5, 0, 1e9, 1]]})", 7),
              ElementsAre(Box{1, 2.5, 3, 4}, Box{-5, 0, 1e9, 1}));
  EXPECT_TRUE(parse_boxes(R"({"boxes": [], "image": 0})", 0)->empty());
}

TEST(Boxes, AreRefusedWhereTheAnswerIsNotExactlyThat) {
  for (const char* text : {"",
                           "[]",
                           "{}",
                           "nonsense",
                           R"({"boxes": []})",
                           R"({"image": 7})",
                           R"({"image": 7, "boxes": 3})",
                           R"({"image": 7, "boxes": [3]})",
                           R"({"image": 8, "boxes": []})",
                           R"({"image": "7", "boxes": []})",
                           R"({"image": 7.0, "boxes": []})",
                           R"({"image": -7, "boxes": []})",
                           R"({"image": 7, "boxes": [[1, 2, 3]]})",
                           R"({"image": 7, "boxes": [[1, 2, 3, 4, 5]]})",
                           R"({"image": 7, "boxes": [[1, 2, "3", 4]]})",
                           R"({"image": 7, "boxes": [[1, 2, 0, 4]]})",
                           R"({"image": 7, "boxes": [[1, 2, 3, -4]]})",
                           R"({"image": 7, "boxes": [[1e999, 2, 3, 4]]})",
                           R"({"image": 7, "boxes": [], "more": 1})",
                           R"({"image": 7, "boxes": [], "boxes": []})",
                           R"({"image": 7, "boxes": [[[[1]]]]})"})
    EXPECT_FALSE(parse_boxes(text, 7).ok()) << text;
  std::string many = R"({"image": 7, "boxes": [[0,0,1,1])";
  for (size_t i = 0; i < kMaxBoxes; ++i) many += ",[0,0,1,1]";
  EXPECT_THAT(parse_boxes(many + "]}", 7).status().message(), HasSubstr("10000 at most"));
}

class ProgramDetectorTest : public ::testing::Test {
 protected:
  std::unique_ptr<Detector> make(const std::string& mode) {
    ProgramDetector::Options options{marker_program(scratch_.path(), mode)};
    options.timeout = mode == "finds" ? std::chrono::seconds(20) : std::chrono::seconds(1);
    auto made = ProgramDetector::create(options);
    EXPECT_OK(made);
    return made.ok() ? *std::move(made) : nullptr;
  }
  /// Asks until it is ready again.
  static Result<std::vector<Box>> find_when_ready(Detector& detector, const DetectorImage& image) {
    for (int i = 0; i < 400; ++i) {
      auto boxes = detector.find(image);
      if (boxes.ok() || i == 399) return boxes;
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
    }
    return unavailable("");
  }
  static uint64_t starts(const Detector& detector) {
    return dynamic_cast<const ProgramDetector&>(detector).starts();
  }

  ScratchDirectory scratch_;
  idf::NdArray secret_ = image_with_secret(64, 48, 20, 10);
  idf::NdArray plain_ = image_with_secret(64, 48, -1, 0);
};

TEST_F(ProgramDetectorTest, GetsImagesAndGivesBoxes) {
  const auto detector = make("finds");
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(*detector->find(seen(secret_)), ElementsAre(Box{20, 10, 16, 16}));
    EXPECT_TRUE(detector->find(seen(plain_))->empty());
  }
  EXPECT_EQ(starts(*detector), 1u);
}

TEST_F(ProgramDetectorTest, GivesNoAnswerForWhatAProgramBreaksOnAndStartsItAgain) {
  for (const char* mode : {"silent", "dies", "garbage", "endless"}) {
    SCOPED_TRACE(mode);
    const auto detector = make(mode);
    EXPECT_OK(detector->find(seen(plain_)));
    const SteadyTime began = steady_now();
    EXPECT_EQ(detector->find(seen(secret_)).status().code(), StatusCode::kUnavailable) << mode;
    EXPECT_LT(steady_now() - began, std::chrono::seconds(20)) << mode;
    // It is not ready at once, and says so without a wait.
    EXPECT_OK(find_when_ready(*detector, seen(plain_)));
    EXPECT_EQ(starts(*detector), 2u) << mode;
  }
}

TEST_F(ProgramDetectorTest, TakesNoAnswerForThatOfTheNextImage) {
  const auto detector = make("chatty");
  EXPECT_OK(detector->find(seen(secret_)));
  // The second line may come at any time.
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_THAT(detector->find(seen(plain_)).status().message(),
              HasSubstr("the number of the image"));
  EXPECT_TRUE(find_when_ready(*detector, seen(plain_))->empty());
}

TEST_F(ProgramDetectorTest, IsAnErrorWhereItDoesNotGetReady) {
  ProgramDetector::Options options{{"/no/such/program"}};
  EXPECT_EQ(ProgramDetector::create(options).status().code(), StatusCode::kNotFound);
  for (const char* mode : {"mute", "ends", "rude"}) {
    options.command = marker_program(scratch_.path(), mode);
    options.start_timeout = std::chrono::seconds(mode == std::string("mute") ? 1 : 20);
    EXPECT_EQ(ProgramDetector::create(options).status().code(), StatusCode::kFailedPrecondition)
        << mode;
  }
  EXPECT_EQ(ProgramDetector::create({}).status().code(), StatusCode::kInvalidArgument);
}

TEST_F(ProgramDetectorTest, LeavesNoProcessBehind) {
  for (const char* mode : {"finds", "silent"}) {
    const auto detector = make(mode);
    EXPECT_EQ(detector->find(seen(secret_)).ok(), mode == std::string("finds"));
  }
  // No child of this process is left, not even a dead one.
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

TEST_F(ProgramDetectorTest, DiesWithTheProcessThatIsKilled) {
  const std::filesystem::path noted = scratch_.path() / "pid";
  const std::filesystem::path script = scratch_.path() / "note.sh";
  std::ofstream(script) << "echo $$ > " << noted.string()
                        << "\necho '{\"ready\": true}'\ntrap '' TERM INT HUP PIPE\n"
                           "while true; do sleep 0.1; done\n";
  const pid_t child = ::fork();
  if (child == 0) {
    const auto detector = ProgramDetector::create({{"/bin/sh", script.string()}});
    ::kill(::getpid(), SIGKILL);
  }
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  pid_t program = 0;
  std::ifstream(noted) >> program;
  ASSERT_GT(program, 0);
  bool is_gone = false;
  for (int i = 0; i < 200 && !is_gone; ++i) {
    std::ifstream state("/proc/" + std::to_string(program) + "/stat");
    std::string line;
    is_gone = !std::getline(state, line) || line.find(") Z ") != std::string::npos;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_TRUE(is_gone);
}

TEST(OnnxDetector, FindsByTheOutputsOfYoloAndSsd) {
  const ScratchDirectory scratch;
  // The cell in the second column of the third row is bright. The image is twice the input.
  std::vector<uint8_t> pixels(128 * 128 * 3, 30);
  for (int y = 64; y < 96; ++y)
    for (int x = 32; x < 64; ++x)
      for (int c = 0; c < 3; ++c) pixels[static_cast<size_t>((y * 128 + x) * 3 + c)] = 250;
  const auto image = idf::NdArray::take({128, 128, 3}, pixels);
  for (const bool is_ssd : {false, true}) {
    OnnxDetector::Options options{bright_cells_onnx(scratch.path(), is_ssd), 0.5, {}, 64};
    const auto detector = OnnxDetector::create(options);
    ASSERT_OK(detector);
    EXPECT_THAT(*(*detector)->find(seen(image)), ElementsAre(Box{32, 64, 32, 32})) << is_ssd;
    options.classes = {is_ssd ? 1 : 0};
    EXPECT_EQ((*(*OnnxDetector::create(options))->find(seen(image))).size(), 1u);
    options.classes = {5};
    EXPECT_TRUE((*(*OnnxDetector::create(options))->find(seen(image))).empty());
    options.threshold = 0.99;
    options.classes = {};
    EXPECT_TRUE((*(*OnnxDetector::create(options))->find(seen(image))).empty());
  }
}

TEST(OnnxDetector, IsAnErrorWhereItGivesAnythingElseThanItsLayouts) {
  const ScratchDirectory scratch;
  const std::pair<testing::OnnxFault, std::string> faults[] = {
      {testing::OnnxFault::kTransposed, "an output of shape [1, 16, 5]"},
      {testing::OnnxFault::kParts, "boxes in parts of its input"},
      {testing::OnnxFault::kTwoOutputs, "has 2 outputs"}};
  for (const auto& [fault, says] : faults) {
    const auto detector =
        OnnxDetector::create({bright_cells_onnx(scratch.path(), false, 64, 4, fault), 0.5, {}, 64});
    EXPECT_EQ(detector.status().code(), StatusCode::kFailedPrecondition) << says;
    EXPECT_THAT(detector.status().message(), HasSubstr(says));
  }
  for (const bool is_ssd : {false, true}) {
    const auto file = bright_cells_onnx(scratch.path(), is_ssd, 64, 4, testing::OnnxFault::kScores);
    // A black image has scores of 1, which may be; any other has more.
    const auto detector = OnnxDetector::create({file, 0.5, {}, 64});
    const auto grey = idf::NdArray::take({64, 64, 3}, std::vector<uint8_t>(64 * 64 * 3, 128));
    ASSERT_OK(detector);
    EXPECT_EQ((*detector)->find(seen(grey)).status().code(), StatusCode::kUnavailable) << is_ssd;
  }
}

TEST(OnnxDetector, GivesNoAnswerWhereAScoreIsNoNumber) {
  const ScratchDirectory scratch;
  const auto bright = idf::NdArray::take({64, 64, 3}, std::vector<uint8_t>(64 * 64 * 3, 250));
  for (const bool is_ssd : {false, true}) {
    const auto file =
        bright_cells_onnx(scratch.path(), is_ssd, 64, 4, testing::OnnxFault::kNoNumber);
    // Of a class that nobody asks for, too.
    for (const std::vector<int>& classes : {std::vector<int>{}, {7}}) {
      const auto detector = OnnxDetector::create({file, 0.5, classes, 64});
      ASSERT_OK(detector);
      const auto boxes = (*detector)->find(seen(bright));
      EXPECT_EQ(boxes.status().code(), StatusCode::kUnavailable) << is_ssd;
      EXPECT_THAT(boxes.status().message(), HasSubstr("nan"));
    }
  }
}

TEST(OnnxDetector, IsAnErrorWhereTheFileIsNoSuchNetwork) {
  const ScratchDirectory scratch;
  OnnxDetector::Options options{scratch.path() / "none.onnx"};
  EXPECT_EQ(OnnxDetector::create(options).status().code(), StatusCode::kNotFound);
  options.file = scratch.path();
  EXPECT_EQ(OnnxDetector::create(options).status().code(), StatusCode::kNotFound);
  options.file = scratch.path() / "text.onnx";
  std::ofstream(options.file) << "this is no network";
  EXPECT_EQ(OnnxDetector::create(options).status().code(), StatusCode::kFailedPrecondition);
  // A network for inputs of another size.
  options.file = bright_cells_onnx(scratch.path(), false, 64, 4);
  options.size = 320;
  EXPECT_FALSE(OnnxDetector::create(options).ok());
  options.size = 1;
  EXPECT_EQ(OnnxDetector::create(options).status().code(), StatusCode::kInvalidArgument);
}

TEST(FacesDetector, IsAnErrorWhereTheCascadeIsNone) {
  const ScratchDirectory scratch;
  EXPECT_EQ(FacesDetector::create({scratch.path() / "none.xml"}).status().code(),
            StatusCode::kNotFound);
  std::ofstream(scratch.path() / "text.xml") << "<xml/>";
  EXPECT_EQ(FacesDetector::create({scratch.path() / "text.xml"}).status().code(),
            StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::ltm
