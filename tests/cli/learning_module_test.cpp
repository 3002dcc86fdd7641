// SPDX-License-Identifier: Apache-2.0
// LibTorch is loaded where something learns or decodes, and nowhere else; without the module that
// brings it all that is recorded can still be read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "memory/memory.h"
#include "reports/plain/save.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = reports::Json;

const fs::path kProgram = ENGRAM_REAL_PROGRAM;
const fs::path kModule = ENGRAM_REAL_MODULE;
const fs::path kGolden = fs::path(ENGRAM_SOURCE_DIR) / "tests/golden/store/format_1";
const std::string kReconstructed = kCamera + " @ before:2020-09-13T12:26:44.800";

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class LearningModule : public ::testing::Test {
 protected:
  LearningModule() { fs::copy(kGolden, store_, fs::copy_options::recursive); }

  /// Runs the program; the dynamic linker lists what it loads.
  [[nodiscard]] RunResult run(const std::vector<std::string>& arguments) {
    loaded_.clear();
    const fs::path lists = directory_ / "loaded";
    fs::create_directories(lists);
    ::setenv("LD_DEBUG", "files", 1);
    ::setenv("LD_DEBUG_OUTPUT", (lists / "of").c_str(), 1);
    RunResult result = run_engram(arguments);
    ::unsetenv("LD_DEBUG");
    ::unsetenv("LD_DEBUG_OUTPUT");
    for (const auto& file : fs::directory_iterator(lists)) loaded_ += text_of(file.path());
    fs::remove_all(lists);
    return result;
  }

  /// Whether the last run() loaded LibTorch.
  [[nodiscard]] bool has_libtorch() const { return has_loaded("libtorch_cpu.so"); }

  [[nodiscard]] bool has_loaded(const std::string& library) const {
    EXPECT_THAT(loaded_, HasSubstr("libopencv_core.so")) << "nothing was listed";
    return loaded_.find(library) != std::string::npos;
  }

  ScratchDirectory directory_;
  const std::string store_ = directory_ / "robot.engram";

 private:
  std::string loaded_;
};

TEST_F(LearningModule, IsNotLoadedWhereNothingLearnsOrDecodes) {
  const std::string changed = directory_ / "changed.engram";
  const auto recording = make_recording(directory_.path(), 2);
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{"info", store_},
        {"ls", store_, kCamera},
        {"query", store_, kCamera + " @ all"},
        {"query", store_, kReconstructed, "--prefer", "recorded"},
        {"query", store_, "Speech @ all", "--prefer", "latent"},
        {"export", store_, "--to", "jsonl", "-o", directory_ / "out"},
        {"forget", store_, "Speech @ all", "--yes"},
        {"compact", store_},
        {"commit", "--db", store_, "Objects/Things/kitchen/cup", "--data", "{\"height\": 0.1}"},
        import_arguments(recording, changed),
        {"query", changed, "RobotState @ +200ms"},
        {"predict", changed, kJoints, "--horizons", "200ms", "--list"},
        {"predict", changed, kJoints, "--horizons", "+200ms", "--engine", "copy-last"},
        {"models", changed},
        {"models", store_},
        {"models", store_, "--snapshots", "--json"},
        {"check", changed},
        {"-q", "check", changed},
        {"recover", changed, "-o", directory_ / "recovered.engram"}}) {
    const RunResult result = run(line);
    EXPECT_EQ(result.exit_code, 0) << line[0] << ": " << result.err;
    EXPECT_FALSE(has_libtorch()) << line[0];
    // OpenCV's reader of image files loads GDAL and 63 more, in twice the time of all else.
    EXPECT_FALSE(has_loaded("libopencv_imgcodecs.so")) << line[0];
  }
}

TEST_F(LearningModule, IsNotLoadedToAskAServer) {
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{"predict", "--server", "127.0.0.1:1", kCamera},
        {"predict", "--server", "127.0.0.1:1", kCamera, "--list"},
        {"query", kCamera + " @ +200ms", "--server", "127.0.0.1:1"}}) {
    const RunResult result = run(line);
    EXPECT_EQ(result.exit_code, 1) << line[0];
    EXPECT_THAT(result.err, HasSubstr("127.0.0.1:1")) << line[0];
    EXPECT_FALSE(has_libtorch()) << line[0];
  }
}

TEST_F(LearningModule, IsLoadedToDecodeAndDecodesAsADirectlyLinkedLibrary) {
  const RunResult told = run({"query", store_, kReconstructed, "--prefer", "latent", "--json"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  EXPECT_TRUE(has_libtorch());
  // This test is linked with LibTorch, as every program of others is.
  const auto memory = *Memory::open(store_, {.is_read_only = true, .prefers_latents = true});
  const auto answer = *memory->query(kReconstructed);
  const ltm::EntityResult& camera = *answer.entities().front();
  ASSERT_EQ(camera.snapshots.size(), 1u);
  ASSERT_EQ(camera.snapshots.front().source, ltm::Source::kReconstructed);
  EXPECT_EQ(Json::parse(told.out).at("entities").at(0).at("snapshots").at(0),
            *reports::snapshot_json(camera.id, camera.snapshots.front()));
}

TEST_F(LearningModule, IsLoadedForWhatLearnsAndTestsModels) {
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{"check", store_},
        {"predict", store_, kCamera, "--horizons", "+200ms", "--engine", "deep"},
        {"consolidate", store_, "--dry-run"}}) {
    const RunResult result = run(line);
    EXPECT_EQ(result.exit_code, 0) << line[0] << ": " << result.err;
    EXPECT_TRUE(has_libtorch()) << line[0];
  }
}

/// The program in a folder of its own, beside which there is no module, or another file as such.
class WithoutModule : public LearningModule {
 protected:
  WithoutModule() { fs::copy_file(kProgram, program_); }

  [[nodiscard]] RunResult run(const std::string& arguments) const {
    const std::string out = directory_ / "stdout";
    const std::string err = directory_ / "stderr";
    const int status =
        ::system(("'" + program_.string() + "' " + arguments + " > " + out + " 2> " + err).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
  }

  void expect_module_told(const std::string& arguments) const {
    const RunResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << arguments << result.out;
    EXPECT_THAT(result.err, HasSubstr(module_.string())) << arguments;
  }

  const fs::path program_ = directory_ / "engram-program";
  const fs::path module_ = directory_ / kModule.filename();
};

TEST_F(WithoutModule, WhatIsRecordedIsReadAndAllElseSaysWhatIsMissing) {
  for (const std::string& line :
       {"info " + store_, "ls " + store_, "query " + store_ + " '" + kCamera + " @ all'",
        "query " + store_ + " --help"})
    EXPECT_EQ(run(line).exit_code, 0) << line << run(line).err;
  expect_module_told("query " + store_ + " '" + kReconstructed + "' --prefer latent");
  expect_module_told("consolidate " + store_);
  expect_module_told("eval " + store_);
}

TEST_F(WithoutModule, AModelThatCannotBeTestedIsNotTakenForDamaged) {
  expect_module_told("check " + store_);
  const fs::path recovered = directory_ / "recovered.engram";
  expect_module_told("recover " + store_ + " -o " + recovered.string());
  EXPECT_FALSE(fs::exists(recovered));
}

TEST_F(WithoutModule, AFileThatIsNoModuleOfThisBuildIsRefused) {
  std::ofstream(module_) << "no library";
  expect_module_told("eval " + store_);
  fs::remove(module_);
  fs::copy_file(OTHER_LIBRARY, module_);
  expect_module_told("eval " + store_);
  EXPECT_THAT(run("eval " + store_).err, HasSubstr("is of another build: found no module"));
}

}  // namespace
}  // namespace engram::cli
