// SPDX-License-Identifier: Apache-2.0
// Unique images are erased from stores of every form; no file and no answer may show them then.
#include "training/fade/erase.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <set>
#include <thread>

#include "encoders/deep_model_file.h"
#include "encoders/load_model.h"
#include "ltm/codec/group_codec.h"
#include "ltm/core/file.h"
#include "ltm/forgetting/carry_out.h"
#include "ltm/forgetting/redact_store.h"
#include "ltm/recall/recall.h"
#include "ltm/store/night_lock.h"
#include "ltm/store/recover.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_check.h"
#include "tests/training/textured_room.h"
#include "training/fade/fade.h"
#include "training/fade/learned_from.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::ScratchPath;

constexpr int kCount = 64;
constexpr int kHeight = 48, kWidth = 64;

/// What stores of a test hold.
struct Form {
  std::string name;
  Representation kind = Representation::kVideo;
  bool has_numbers = false;
  bool drops_recorded = true;
  std::optional<double> fades_to = {};
  bool is_gist = false;
};

std::ostream& operator<<(std::ostream& out, const Form& form) {
  return out << form.name;
}

bool is_canary(int index) {
  return index % 13 == 5;
}

/// Canaries have squares of colours that no other image has; the others show a moving scene.
std::vector<uint8_t> pixels_of(int index) {
  std::vector<uint8_t> pixels;
  std::mt19937 random(static_cast<uint32_t>(index) + 100);
  std::vector<uint8_t> colours(6 * 8 * 3);
  for (uint8_t& colour : colours) colour = random() % 2 == 0 ? 10 : 245;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) {
        const int wave = 70 + 60 * ((x + index) / 8 % 2) + 40 * (y / 8 % 2);
        const size_t square = (static_cast<size_t>(y) / 8 * 8 + static_cast<size_t>(x) / 8) * 3;
        pixels.push_back(is_canary(index) ? colours[square + static_cast<size_t>(c)]
                                          : static_cast<uint8_t>(wave));
      }
  return pixels;
}

idf::Data value_at(int index, bool has_numbers) {
  idf::Dict value{{"image", idf::NdArray::take({kHeight, kWidth, 3}, pixels_of(index))}};
  if (has_numbers) value.set("joint", std::sin(0.1 * index));
  return value;
}

const idf::NdArray& image_of(const idf::Data& value) {
  return value.get<idf::Dict>().find("image")->get<idf::NdArray>();
}

class EraseTest : public ::testing::TestWithParam<Form> {
 protected:
  EraseTest() : store_("erase") {}

  /// Makes the store, with canaries.
  void make() {
    auto recorder = ltm::Recorder::open(store_.path(), {});
    for (int i = 0; i < kCount; ++i) {
      recorded_.push_back(value_at(i, GetParam().has_numbers));
      const ltm::Snapshot snapshot{entity_, time(i), {{recorded_.back(), {}}}};
      EXPECT_TRUE(recorder->commit({{snapshot}}).ok());
      if (is_canary(i)) gone_[entity_].insert(time(i));
    }
    EXPECT_TRUE(recorder->close().ok());
    consolidate_store();
    if (GetParam().drops_recorded) {
      EXPECT_TRUE(ltm::drop_recorded(store_.path(), entity_, {}).ok());
    }
    if (GetParam().fades_to || GetParam().is_gist) {
      ltm::FadingSnapshots part{GetParam().fades_to, {}};
      for (int i = 0; i < kCount; ++i) part.times.insert(time(i));
      EXPECT_TRUE(fade(store_.path(), {{entity_, {part}}}, {}, {}).ok());
    }
  }

  void consolidate_store() const {
    ConsolidateOptions options;
    options.representation.kind = GetParam().kind;
    options.representation.bound_db = 36;
    options.representation.video_effort = 1;
    options.access = Duration::zero();
    options.train = engram::testing::quick_options(10);
    options.train.chain_rows = 16;
    const auto report = consolidate(store_.path(), options, {}, {});
    EXPECT_TRUE(report.ok()) << report.status().to_string();
  }

  static Time time(int index) { return time_from_ns(int64_t{index + 1} * 200'000'000); }
  static size_t index_of(Time time) { return static_cast<size_t>(to_ns(time) / 200'000'000) - 1; }

  [[nodiscard]] std::unique_ptr<ltm::StoreReader> reader() const {
    return *ltm::StoreReader::open(store_.path());
  }

  ltm::ForgetPlan plan() const {
    ltm::ForgetPlan plan;
    for (const auto& [entity, times] : gone_) plan.entities[entity].gone = times;
    return plan;
  }

  Result<ltm::ForgetReport> erase() {
    return ltm::carry_out(store_.path(), plan(), {}, {}, {}, {fade, code_anew});
  }

  /// Pieces of the blocks that hold a canary.
  [[nodiscard]] std::set<std::string> pieces_of_canaries() const {
    std::set<std::string> pieces;
    const auto opened = reader();
    for (const ltm::SnapshotEntry& entry : **opened->index(entity_)) {
      if (!entry.latent || !is_canary(static_cast<int>(index_of(entry.time)))) continue;
      const auto latents = *opened->read_latent(entity_, entry);
      const auto code = as_text(latents.instances.front().latent.code.bytes());
      constexpr size_t kPiece = 24;
      if (code.size() > kPiece) pieces.emplace(code.substr(code.size() / 2 - kPiece / 2, kPiece));
    }
    return pieces;
  }

  [[nodiscard]] std::set<std::string> files_with(const std::set<std::string>& pieces) const {
    return files_with(pieces, store_.path());
  }

  /// The files of a store that hold any of the pieces.
  [[nodiscard]] static std::set<std::string> files_with(const std::set<std::string>& pieces,
                                                        const std::filesystem::path& store) {
    std::set<std::string> files;
    for (const auto& file : std::filesystem::recursive_directory_iterator(store)) {
      if (!file.is_regular_file()) continue;
      const Buffer content = *read_file(file.path());
      for (const std::string& piece : pieces)
        if (as_text(content.bytes()).find(piece) != std::string_view::npos)
          files.insert(file.path().filename().string());
    }
    return files;
  }

  /// No image of an answer, and no picture of a model, looks like a canary; what stays is as good
  /// as told.
  void expect_erased() const {
    ltm::Recall recall(reader(), encoders::load_model);
    const auto found = recall.query(ltm::Query::of_entity(entity_, ltm::select::All{}), {});
    ASSERT_TRUE(found.ok()) << found.status().to_string();
    const auto& answers = found->entities().front()->snapshots;
    EXPECT_EQ(answers.size(), kCount - gone_.at(entity_).size());
    for (const ltm::SnapshotResult& answer : answers) {
      const auto index = index_of(answer.time);
      EXPECT_FALSE(gone_.at(entity_).contains(answer.time));
      const idf::Data& value = answer.instances.front().data;
      expect_unlike_canaries(image_of(value));
      if (answer.source != ltm::Source::kReconstructed) continue;
      const ltm::MeasuredError real = *compare(recorded_[index], value);
      const auto& instance = answer.instances.front();
      const double told = (instance.bound ? *instance.bound : *instance.error).image_mse;
      EXPECT_LE(real.image_mse, told * 1.01) << index;
    }
    const auto report = ltm::check_store(store_.path(), {}, {}, {});
    ASSERT_TRUE(report.ok());
    for (const ltm::Finding& finding : report->findings) ADD_FAILURE() << finding.what;
  }

  /// Models of networks and numbers had learned from the canaries; others know no content.
  void expect_learned_models_gone(const std::vector<ltm::ModelInfo>& before) const {
    const bool has_learned = GetParam().has_numbers || GetParam().kind == Representation::kLatents;
    for (const ltm::ModelInfo& model : before)
      EXPECT_TRUE(!has_learned || !std::filesystem::exists(store_.path() / model.file))
          << model.file;
  }

  void expect_unlike_canaries(const idf::NdArray& image) const {
    for (int canary = 0; canary < kCount; ++canary) {
      if (!is_canary(canary)) continue;
      const double like =
          psnr_db(*image_mse(image_of(recorded_[static_cast<size_t>(canary)]), image));
      EXPECT_LT(like, 9) << "looks like canary " << canary;
    }
  }

  ltm::MemoryId entity_ = id("Vision/RGB/head/cam");
  ScratchPath store_;
  std::vector<idf::Data> recorded_;
  ltm::ForgetSet gone_;
};

class KilledErasing : public EraseTest {};
class NightAfterErasing : public EraseTest {};

TEST_P(EraseTest, LeavesNothingOfACanary) {
  make();
  const auto pieces = pieces_of_canaries();
  ASSERT_FALSE(pieces.empty());
  const auto before = reader()->manifest().models;
  const auto report = erase();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->rewritten.snapshots, gone_[entity_].size());
  const ltm::EntityErasure& erased = report->erased->entities.at(entity_);
  EXPECT_EQ(erased.erased, gone_[entity_].size());
  EXPECT_GT(GetParam().drops_recorded ? erased.recoded : erased.uncoded, 0U);
  expect_erased();
  EXPECT_THAT(files_with(pieces), ::testing::IsEmpty());
  expect_learned_models_gone(before);
  EXPECT_TRUE(std::filesystem::exists(store_.path() / report->erased->report));
  // Nothing comes back.
  ASSERT_TRUE(ltm::compact(store_.path(), {}).ok());
  expect_erased();
  const ScratchPath copy("erase_recovered");
  ASSERT_TRUE(ltm::recover_store(store_.path(), copy.path()).ok());
  EXPECT_THAT(files_with(pieces, copy.path()), ::testing::IsEmpty());
}

TEST_P(EraseTest, FindsWhatForgettingHadLeft) {
  make();
  const auto pieces = pieces_of_canaries();
  ASSERT_TRUE(ltm::forget_snapshots(store_.path(), gone_).ok());
  EXPECT_THAT(files_with(pieces), ::testing::Not(::testing::IsEmpty()));
  const auto before = reader()->manifest().models;
  const auto report = ltm::carry_out(store_.path(), {}, {}, {}, {}, {fade, code_anew});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  expect_erased();
  expect_learned_models_gone(before);
  // Now there is nothing left to do.
  const auto models = reader()->manifest().models;
  ASSERT_TRUE(ltm::carry_out(store_.path(), {}, {}, {}, {}, {fade, code_anew}).ok());
  EXPECT_EQ(reader()->manifest().models.size(), models.size());
  for (const ltm::ModelInfo& model : models)
    EXPECT_TRUE(std::filesystem::exists(store_.path() / model.file)) << model.file;
  EXPECT_THAT(files_with(pieces), ::testing::IsEmpty());
}

TEST_P(KilledErasing, IsDoneByTheNextRun) {
  make();
  const auto pieces = pieces_of_canaries();
  std::mt19937 random(7);
  for (int round = 0; round < 3; ++round) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(erase().ok() ? 0 : 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + random() % 300));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  const auto report = erase();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  expect_erased();
  EXPECT_THAT(files_with(pieces), ::testing::IsEmpty());
}

TEST_P(NightAfterErasing, FindsNothingOfACanary) {
  make();
  ASSERT_TRUE(erase().ok());
  consolidate_store();
  expect_erased();
  EXPECT_EQ(reader()->summary(entity_)->latent_snapshots, kCount - gone_[entity_].size());
}

/// Redacts canaries in whatever form they are kept. The detector knows them by their times, because
/// a network that was hardly trained shows nothing that a program could find.
class RedactedForms : public EraseTest {
 protected:
  Result<ltm::StoreRedaction> redact() {
    const std::filesystem::path program = folder_.path() / "find_canaries.py";
    std::filesystem::create_directories(folder_.path());
    std::ofstream(program) << R"(import json, sys
print('{"ready": true}', flush=True)
while line := sys.stdin.buffer.readline():
    head = json.loads(line)
    pixels = sys.stdin.buffer.read(head['bytes'])
    found = (head['time_ns'] // 200000000 - 1) % 13 == 5
    boxes = [[0, 0, head['width'], head['height']]] if found else []
    print(json.dumps({'image': head['image'], 'boxes': boxes}), flush=True)
)";
    ltm::StoreRedactionJob job{.store = store_.path()};
    ltm::ProgramDetector::Options detector{{"/usr/bin/python3", program.string()}};
    detector.timeout = std::chrono::minutes(1);
    job.options.detector = detector;
    job.options.action = ltm::RedactAction::kFill;
    job.options.hold = Duration(0);
    job.loader = encoders::load_model;
    job.code_anew = code_anew;
    return ltm::redact_store(job);
  }

  /// All snapshots are there, canaries black, the others as good as told.
  void expect_redacted() const {
    ltm::Recall recall(reader(), encoders::load_model);
    const auto found = recall.query(ltm::Query::of_entity(entity_, ltm::select::All{}), {});
    ASSERT_TRUE(found.ok()) << found.status().to_string();
    const auto& answers = found->entities().front()->snapshots;
    EXPECT_EQ(answers.size(), static_cast<size_t>(kCount));
    for (const ltm::SnapshotResult& answer : answers) {
      const auto index = index_of(answer.time);
      const idf::Data& value = answer.instances.front().data;
      expect_unlike_canaries(image_of(value));
      if (is_canary(static_cast<int>(index))) {
        EXPECT_EQ(answer.source, ltm::Source::kRecorded);
        for (const uint8_t pixel : image_of(value).values<uint8_t>()) ASSERT_EQ(pixel, 0);
        continue;
      }
      if (answer.source != ltm::Source::kReconstructed) continue;
      const ltm::MeasuredError real = *compare(recorded_[index], value);
      const auto& instance = answer.instances.front();
      const double told = (instance.bound ? *instance.bound : *instance.error).image_mse;
      EXPECT_LE(real.image_mse, told * 1.01) << index;
    }
    const auto report = ltm::check_store(store_.path(), {}, {}, {});
    ASSERT_TRUE(report.ok());
    for (const ltm::Finding& finding : report->findings) ADD_FAILURE() << finding.what;
  }

  void expect_redacted_after_night() const {
    ltm::Recall recall(reader(), encoders::load_model);
    ltm::Recall::Options options;
    options.prefer = ltm::Prefer::kLatent;
    const auto found = recall.query(ltm::Query::of_entity(entity_, ltm::select::All{}), options);
    ASSERT_TRUE(found.ok()) << found.status().to_string();
    EXPECT_EQ(found->entities().front()->snapshots.size(), static_cast<size_t>(kCount));
    for (const ltm::SnapshotResult& answer : found->entities().front()->snapshots)
      expect_unlike_canaries(image_of(answer.instances.front().data));
  }

  ScratchPath folder_{"redact_program"};
};

TEST_P(RedactedForms, ShowNothingOfACanaryAnyMore) {
  make();
  const auto pieces = pieces_of_canaries();
  const auto before = reader()->manifest().models;
  const auto report = redact();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  EXPECT_EQ(report->total().redacted, gone_[entity_].size());
  expect_redacted();
  EXPECT_THAT(files_with(pieces), ::testing::IsEmpty());
  expect_learned_models_gone(before);
  // Nothing comes back, and the next night learns from what is left.
  consolidate_store();
  expect_redacted_after_night();
  EXPECT_THAT(files_with(pieces), ::testing::IsEmpty());
}

TEST_P(RedactedForms, AreDoneByTheNextRunIfOneIsKilled) {
  make();
  const auto pieces = pieces_of_canaries();
  std::mt19937 random(11);
  for (int round = 0; round < 3; ++round) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(redact().ok() ? 0 : 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(100 + random() % 700));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  const auto report = redact();
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  expect_redacted();
  EXPECT_THAT(files_with(pieces), ::testing::IsEmpty());
}

const Form kVideo{"video"};
const Form kRecorded{.name = "recorded", .drops_recorded = false};
const Form kVideoAndNumbers{.name = "video_and_numbers", .has_numbers = true};
const Form kLatents{.name = "latents", .kind = Representation::kLatents, .has_numbers = true};
const Form kRecordedLatents{
    .name = "recorded_latents", .kind = Representation::kLatents, .drops_recorded = false};
const Form kFaded{.name = "faded", .fades_to = 28};
const Form kGist{.name = "gist", .is_gist = true};

const auto kNameOf = [](const auto& form) { return form.param.name; };

INSTANTIATE_TEST_SUITE_P(Forms, EraseTest,
                         ::testing::Values(kVideo, kRecorded, kVideoAndNumbers, kLatents,
                                           kRecordedLatents, kFaded, kGist),
                         kNameOf);
INSTANTIATE_TEST_SUITE_P(Forms, KilledErasing, ::testing::Values(kVideo, kLatents), kNameOf);
INSTANTIATE_TEST_SUITE_P(Forms, NightAfterErasing, ::testing::Values(kRecorded, kRecordedLatents),
                         kNameOf);

INSTANTIATE_TEST_SUITE_P(Forms, RedactedForms,
                         ::testing::Values(kVideo, kRecorded, kLatents, kFaded, kGist), kNameOf);

TEST(EraseReference, TakesThePictureThatVideosBeginFrom) {
  using engram::testing::kRoomCamera, engram::testing::kRoomRows;
  if (!ltm::make_group_codec("av1").ok()) GTEST_SKIP() << "no AV1 encoder is installed";
  for (const bool is_forgotten_first : {false, true}) {
    const ScratchPath store("erase_reference");
    engram::testing::record_rooms(store.path(), 0, 12);
    engram::testing::night(store.path(), engram::testing::as_video(32));
    ASSERT_TRUE(ltm::drop_recorded(store.path(), id(kRoomCamera), {}).ok());
    const ltm::ModelInfo before = ltm::read_manifest(store.path())->models.front();
    const auto references =
        (*encoders::read_model(store.path() / before.file))->codec.chain.references;
    ASSERT_EQ(references.front().size(), 1u);
    const encoders::VideoReference& reference = references.front().front();
    ltm::ForgetPlan plan;
    plan.entities[id(kRoomCamera)].gone.insert(time_from_ns(reference.time));
    if (is_forgotten_first) {
      ASSERT_TRUE(ltm::forget_snapshots(store.path(), plan.to_set()).ok());
      plan = {};
    }
    const auto report = ltm::carry_out(store.path(), plan, {}, {}, {}, {fade, code_anew});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
    const ltm::EntityErasure& erased = report->erased->entities.at(id(kRoomCamera));
    EXPECT_GT(erased.recoded, 0u) << "what began from it";
    EXPECT_GT(erased.copied, 0u) << "what did not";
    const auto models = ltm::read_manifest(store.path())->models;
    ASSERT_EQ(models.size(), 1u);
    EXPECT_NE(models.front().file, before.file);
    const auto after = *encoders::read_model(store.path() / models.front().file);
    EXPECT_TRUE(after->codec.chain.references.front().empty());
    ltm::Recall recall(*ltm::StoreReader::open(store.path()), encoders::load_model);
    const auto answer = recall.query(*ltm::Query::parse("Vision @ all"), {});
    ASSERT_TRUE(answer.ok()) << answer.status().to_string();
    EXPECT_EQ(answer->entities()[0]->snapshots.size(), size_t{12} * kRoomRows - 1);
    const auto checked = ltm::check_store(store.path(), {}, {}, {});
    EXPECT_TRUE(checked->is_clean());
  }
}

TEST(NightLock, KeepsLearningAndErasingApart) {
  const ScratchPath store("night_lock");
  engram::testing::record(store.path(), "Test/Scene/sim/square", 0, 24);
  const auto erase = [&store] {
    return ltm::carry_out(store.path(), {}, {}, {}, {}, {fade, code_anew}).status();
  };
  const auto learn = [&store] {
    return consolidate(store.path(), engram::testing::quick_consolidation(), {}, {}).status();
  };
  {
    const auto night = ltm::NightLock::of_learning(store.path());
    ASSERT_TRUE(night.ok());
    EXPECT_EQ(erase().code(), StatusCode::kFailedPrecondition);
    EXPECT_TRUE(learn().ok()) << "two processes may learn";
  }
  {
    const auto erasing = ltm::NightLock::of_erasing(store.path());
    ASSERT_TRUE(erasing.ok());
    EXPECT_EQ(learn().code(), StatusCode::kFailedPrecondition);
    EXPECT_EQ(erase().code(), StatusCode::kFailedPrecondition);
  }
  EXPECT_TRUE(erase().ok());
}

TEST(LearnedFrom, CountsWhatAModelWasConditionedOn) {
  const auto fitted =
      fit_model(engram::testing::scene_source(24), engram::testing::quick_options(1), {}, {});
  ASSERT_TRUE(fitted.ok()) << fitted.status().to_string();
  encoders::DeepModel& model = *fitted->model;
  const ltm::MemoryId own = id("Test/Scene/sim/square"), joints = id("Robot/State/arm/joints");
  const encoders::TimeSpan span = model.provenance.autoencoder_spans.front();
  const auto is_tainted = [&](const ltm::MemoryId& entity, Time time) {
    return learned_from(model, own, {{entity, {time}}}).is_tainted;
  };
  EXPECT_TRUE(is_tainted(own, span.first));
  EXPECT_FALSE(is_tainted(own, span.last + Duration(1)));
  EXPECT_FALSE(is_tainted(joints, span.first));
  model.condition.emplace().entity = joints.to_string();
  EXPECT_TRUE(is_tainted(joints, span.first));
  EXPECT_FALSE(is_tainted(joints, span.last + Duration(1)));
}

}  // namespace
}  // namespace engram::training
