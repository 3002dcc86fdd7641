// SPDX-License-Identifier: Apache-2.0
// Videos that begin from pictures of their model, and videos that have faded: bits that flip and
// disks that fail are found, nothing wrong is answered, and what is whole stays.
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "encoders/load_model.h"
#include "ltm/codec/group_codec.h"
#include "ltm/recall/recall.h"
#include "ltm/store/publish.h"
#include "ltm/store/recover.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_check.h"
#include "tests/faults/faulty_files.h"
#include "tests/training/textured_room.h"
#include "training/fade/fade.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::kRoomCamera;
using engram::testing::kRoomRows;
using engram::testing::ScratchPath;
using engram::testing::time_of_room;

constexpr int kRecordings = 12;
constexpr int kCount = kRecordings * kRoomRows;
/// So many recordings have faded.
constexpr int kFaded = 4;
constexpr double kBoundDb = 32;
constexpr double kFadedDb = 25;
constexpr int kFlips = 6;  ///< For each file.

Status test_model(const std::filesystem::path& file) {
  return encoders::load_model(file).status();
}

/// What the first recordings fade to.
ltm::FadeSet faded_rooms() {
  ltm::FadingSnapshots part{kFadedDb, {}};
  for (int i = 0; i < kFaded * kRoomRows; ++i) part.times.insert(time_of_room(i));
  return {{id(kRoomCamera), {part}}};
}

void copy_store(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::filesystem::remove_all(to);
  std::filesystem::copy(from, to, std::filesystem::copy_options::recursive);
}

class FadedDamage : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!ltm::make_group_codec("av1").ok()) return;
    fresh_ = std::make_unique<ScratchPath>("damage_fresh");
    engram::testing::record_rooms(fresh_->path(), 0, kRecordings);
    engram::testing::night(fresh_->path(), engram::testing::as_video(kBoundDb));
    ASSERT_TRUE(ltm::drop_recorded(fresh_->path(), id(kRoomCamera), {}).ok());
  }

  static void TearDownTestSuite() { fresh_.reset(); }

  void SetUp() override {
    if (fresh_ == nullptr) GTEST_SKIP() << "no AV1 encoder is installed";
    copy_store(fresh_->path(), store_.path());
  }

  /// Returns how many images an answer has, all of which are as good as it says.
  static int right_of(const Result<ltm::QueryResult>& answer) {
    int right = 0;
    if (!answer.ok()) return right;
    for (const ltm::EntityResult* entity : answer->entities())
      for (const ltm::SnapshotResult& found : entity->snapshots) {
        const int moment = moment_of(found.time);
        const ltm::InstanceResult& instance = found.instances.at(0);
        const auto real = compare(engram::testing::view_of_room(moment), instance.data);
        EXPECT_TRUE(real.ok()) << real.status().to_string();
        if (!real.ok() || moment >= kCount) continue;
        if (instance.error)
          EXPECT_LE(real->image_mse, instance.bound.value_or(*instance.error).image_mse) << moment;
        else
          EXPECT_EQ(real->image_mse, 0) << moment;
        ++right;
      }
    return right;
  }

  static int moment_of(Time time) {
    int moment = 0;
    while (time_of_room(moment) != time) ++moment;
    return moment;
  }

  /// The same of a whole store. Where something is damaged, moments are asked for one by one, so
  /// that an error of one costs no other.
  static int right_answers(const std::filesystem::path& store) {
    auto reader = ltm::StoreReader::open(store);
    if (!reader.ok()) return 0;
    ltm::Recall recall(std::move(*reader), encoders::load_model);
    const ltm::MemoryId camera = id(kRoomCamera);
    if (right_of(recall.query(ltm::Query::of_entity(camera, ltm::select::All{}), {})) == kCount)
      return kCount;
    int right = 0;
    for (int i = 0; i < kCount; ++i) {
      const auto query = ltm::Query::of_entity(camera, ltm::select::At{time_of_room(i)});
      right += right_of(recall.query(query, {}));
    }
    return right;
  }

  static bool has_fault(const std::filesystem::path& store, const std::string& file) {
    const auto report = ltm::check_store(store, {});
    return !report.ok() || std::ranges::any_of(report->findings, [&](const ltm::Finding& each) {
      return each.severity == ltm::Severity::kFault && each.file == file;
    });
  }

  static void expect_no_fault(const std::filesystem::path& store) {
    const auto report = ltm::check_store(store, {.is_deep = true, .test_model = test_model});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
    for (const ltm::Finding& finding : report->findings)
      EXPECT_NE(finding.severity, ltm::Severity::kFault) << finding.file << ": " << finding.what;
  }

  /// Flips a bit and returns how the byte was.
  static char flip(const std::filesystem::path& file, uint64_t bit) {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(bit / 8));
    const char before = static_cast<char>(stream.get());
    write(stream, bit / 8, static_cast<char>(before ^ (1 << bit % 8)));
    return before;
  }

  static void write(std::fstream& stream, uint64_t at, char byte) {
    stream.seekp(static_cast<std::streamoff>(at));
    stream.put(byte);
  }

  /// Whichever change of files fails while `work` runs, nothing is lost, and it works the next
  /// time.
  void fail_everywhere(const std::filesystem::path& from, int64_t stride,
                       const std::function<Status()>& work) {
    // What an earlier test let fail would fail here, too, as soon as there are as many calls.
    faulty_files_fail(0, kFaultNone);
    faulty_files_watch(store_.path().c_str());
    copy_store(from, store_.path());
    const int64_t before = faulty_files_calls();
    ASSERT_TRUE(work().ok());
    const int64_t calls = faulty_files_calls() - before;
    ASSERT_GT(calls, 2 * stride);
    int failed = 0;
    for (int64_t call = 1; call <= calls; call += stride) {
      for (const int kind : {kFaultShort, kFaultFull, kFaultBroken, kFaultDead}) {
        SCOPED_TRACE(fmt::format("call {} of {}, fault {}", call, calls, kind));
        faulty_files_watch("/nothing");
        copy_store(from, store_.path());
        faulty_files_watch(store_.path().c_str());
        faulty_files_fail(call, kind);
        failed += work().ok() ? 0 : 1;
        faulty_files_watch("/nothing");
        EXPECT_EQ(right_answers(store_.path()), kCount);
        const Status again = work();
        EXPECT_TRUE(again.ok()) << again.to_string();
        EXPECT_EQ(right_answers(store_.path()), kCount);
        expect_no_fault(store_.path());
      }
    }
    EXPECT_GT(failed, 0);
  }

  ScratchPath store_{"damage"};
  static std::unique_ptr<ScratchPath> fresh_;
};

std::unique_ptr<ScratchPath> FadedDamage::fresh_;

TEST_F(FadedDamage, OneFlippedBitIsFoundAndNothingWrongIsAnswered) {
  ASSERT_TRUE(fade(store_.path(), faded_rooms(), {}, {}).ok());
  ASSERT_EQ(right_answers(store_.path()), kCount);
  expect_no_fault(store_.path());
  const auto manifest = ltm::read_manifest(store_.path());
  std::vector<std::string> files;
  for (const ltm::SegmentInfo& segment : manifest->segments) files.push_back(segment.file);
  for (const ltm::ModelInfo& model : manifest->models) files.push_back(model.file);
  ASSERT_GE(files.size(), 3u);
  std::mt19937 random(3);
  for (const std::string& file : files) {
    const std::filesystem::path path = store_.path() / file;
    const uint64_t bits = 8 * std::filesystem::file_size(path);
    for (int i = 0; i < kFlips; ++i) {
      const uint64_t bit = std::uniform_int_distribution<uint64_t>(0, bits - 1)(random);
      SCOPED_TRACE(fmt::format("{} bit {}", file, bit));
      const char before = flip(path, bit);
      EXPECT_TRUE(has_fault(store_.path(), file));
      const int answered = right_answers(store_.path());
      if (i % 4 == 0) {
        const ScratchPath copy("damage_copy");
        const auto report =
            ltm::recover_store(store_.path(), copy.path(), {.test_model = test_model});
        ASSERT_TRUE(report.ok()) << report.status().to_string();
        const int saved = right_answers(copy.path());
        EXPECT_GE(saved, answered);
        EXPECT_EQ(report->has_loss(), saved < kCount);
        expect_no_fault(copy.path());
      }
      std::fstream stream(path, std::ios::in | std::ios::out | std::ios::binary);
      write(stream, bit / 8, before);
    }
  }
  EXPECT_EQ(right_answers(store_.path()), kCount);
}

TEST_F(FadedDamage, FadingLosesNothingWhicheverCallFails) {
  fail_everywhere(fresh_->path(), 11,
                  [&] { return fade(store_.path(), faded_rooms(), {}, {}).status(); });
}

TEST_F(FadedDamage, ANightWithReferencesLosesNothingWhicheverCallFails) {
  const ScratchPath recorded("damage_recorded");
  copy_store(fresh_->path(), recorded.path());
  engram::testing::record_rooms(recorded.path(), kRecordings, 1);
  fail_everywhere(recorded.path(), 5, [&] {
    const auto report = consolidate(store_.path(), engram::testing::as_video(kBoundDb), {}, {});
    return report.ok() ? Status() : report.status();
  });
}

}  // namespace
}  // namespace engram::training
