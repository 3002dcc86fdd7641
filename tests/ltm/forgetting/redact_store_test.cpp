// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/redact_store.h"

#include <gmock/gmock.h>

#include <set>

#include "ltm/codec/group_codec.h"
#include "ltm/core/file.h"
#include "ltm/forgetting/redacted_days.h"
#include "ltm/store/store_check.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

using ::testing::ElementsAre;
using testing::has_secret;
using testing::image_with_secret;
using ::testing::Key;
using testing::marker_redaction;
using ::testing::Pair;

constexpr int kCount = 12;

/// Every third snapshot shows a secret.
bool shows_secret(int index) {
  return index % 3 == 1;
}

class RedactStoreTest : public ::testing::Test {
 protected:
  static Time time(int index) { return time_from_ns(1'000'000'000 * int64_t{index + 1}); }
  static MemoryId camera() { return *MemoryId::parse("Vision/RGB/head/cam"); }

  static Snapshot snapshot(int index) {
    InstanceMetadata metadata{time(index), time(index), time(index), "camera", 0.5f};
    const auto image = image_with_secret(64, 48, shows_secret(index) ? 10 + index : -1, 5);
    return {camera(), time(index), {{idf::Dict{{"n", index}, {"image", image}}, metadata}}};
  }

  /// Shows a secret without the marker that the detector finds it by.
  static Snapshot unmarked(int index) {
    Snapshot hidden = snapshot(index);
    auto image = image_with_secret(64, 48, 10, 5);
    std::vector<uint8_t> pixels(image.values<uint8_t>().begin(), image.values<uint8_t>().end());
    pixels[(5 * 64 + 10) * 3 + 1] = 1;
    *hidden.instances[0].data.at("image") = idf::NdArray::take({48, 64, 3}, pixels);
    return hidden;
  }

  /// Seals a store, with images by this codec.
  void make(const std::string& codec = "png", int count = kCount,
            Snapshot (*show)(int index) = snapshot) {
    const PackOptions pack{.rules = {{.kind = MediumKind::kImage, .codec = codec}}};
    ASSERT_OK(create_store(store_));
    StoreWriter::Options writing{.durability = Durability::kNone};
    writing.seal_rules = [&pack](const MemoryId&) { return *SealRules::create(pack); };
    const auto writer = *StoreWriter::open(store_, writing);
    for (int i = 0; i < count; ++i) {
      Snapshot shown = show(i);
      shown.time = time(i);
      PackedSnapshot packed = pack_snapshot(shown);
      packed.instances[0].value = *engram::ltm::pack(shown.instances[0].data, pack);
      packed.dropped = 2;
      ASSERT_OK(writer->append({packed}, nullptr));
    }
    ASSERT_OK(writer->seal());
  }

  [[nodiscard]] StoreRedactionJob job() const {
    StoreRedactionJob job{.store = store_, .options = marker_redaction(scratch_.path())};
    job.code_anew = [](const auto&, const auto&, const auto&, const auto&) -> Result<Erasures> {
      return Erasures();
    };
    return job;
  }

  /// Reads every snapshot.
  [[nodiscard]] std::vector<Snapshot> all() const {
    const auto reader = *StoreReader::open(store_);
    std::vector<Snapshot> read;
    for (const SnapshotEntry& entry : **reader->index(camera()))
      read.push_back(*reader->read_recorded(camera(), entry));
    return read;
  }

  /// Pieces of the encoded images that show a secret.
  [[nodiscard]] std::set<std::string> pieces() const {
    std::set<std::string> found;
    const auto reader = *StoreReader::open(store_);
    int index = 0;
    for (const SnapshotEntry& entry : **reader->index(camera())) {
      if (!shows_secret(index++)) continue;
      const PackedSnapshot packed = *reader->read_packed(camera(), entry);
      for (const PackedMedium& medium : packed.instances[0].value.media) {
        const auto bytes = as_text(medium.bytes.bytes());
        found.emplace(bytes.substr(bytes.size() / 2, 24));
      }
    }
    return found;
  }

  [[nodiscard]] bool is_in_any_file(const std::set<std::string>& pieces) const {
    for (const auto& file : std::filesystem::recursive_directory_iterator(store_)) {
      if (!file.is_regular_file()) continue;
      const Buffer content = *read_file(file.path());
      for (const std::string& piece : pieces)
        if (as_text(content.bytes()).find(piece) != std::string_view::npos) return true;
    }
    return false;
  }

  void expect_redacted() const {
    const std::vector<Snapshot> read = all();
    ASSERT_EQ(read.size(), static_cast<size_t>(kCount));
    for (int i = 0; i < kCount; ++i) {
      const Snapshot& now = read[static_cast<size_t>(i)];
      const Snapshot before = snapshot(i);
      EXPECT_EQ(now.time, before.time);
      EXPECT_EQ(now.instances[0].metadata, before.instances[0].metadata);
      EXPECT_EQ(*now.instances[0].data.at("n"), *before.instances[0].data.at("n"));
      EXPECT_FALSE(has_secret(now.instances[0].data.at("image")->get<idf::NdArray>()));
      EXPECT_EQ(now == before, !shows_secret(i)) << i;
    }
    const auto checked = check_store(store_, {}, {}, {});
    ASSERT_OK(checked);
    for (const Finding& finding : checked->findings) ADD_FAILURE() << finding.what;
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_ = scratch_ / "store";
};

TEST_F(RedactStoreTest, LeavesNothingOfWhatIsFoundInAnyFile) {
  for (const std::string codec : {"png", "ffv1:group=4"}) {
    if (!codec.starts_with("png") && !make_group_codec(codec).ok()) continue;
    SCOPED_TRACE(codec);
    std::filesystem::remove_all(store_);
    make(codec);
    const auto secrets = pieces();
    ASSERT_TRUE(is_in_any_file(secrets));
    const EntitySummary before = *(*StoreReader::open(store_))->summary(camera());
    const auto report = redact_store(job());
    ASSERT_OK(report);
    EXPECT_EQ(report->total().looked_at, 12u);
    EXPECT_EQ(report->total().redacted, 4u);
    EXPECT_EQ(report->total().boxes, 4u);
    expect_redacted();
    EXPECT_FALSE(is_in_any_file(secrets));
    EXPECT_TRUE(std::filesystem::exists(store_ / report->erased->report));
    // Copies of that day can tell that it was redacted.
    const auto days = read_redacted_days(store_);
    ASSERT_OK(days);
    EXPECT_THAT(*days, ElementsAre(Pair(camera(), ElementsAre(Key(redacted_day(time(1)))))));
    EXPECT_FALSE(std::filesystem::exists(store_ / "erasures/redaction.pending"));
    const EntitySummary summary = *(*StoreReader::open(store_))->summary(camera());
    EXPECT_EQ(summary.forgotten.snapshots, 4u);
    EXPECT_EQ(summary.offered, before.offered + 4);
    EXPECT_EQ(summary.raw_bytes, before.raw_bytes);
    EXPECT_EQ(summary.offered_bytes, before.offered_bytes + before.raw_bytes / 3);
    // There is nothing left to do.
    const auto again = redact_store(job());
    ASSERT_OK(again);
    EXPECT_EQ(again->total().redacted, 0u);
    EXPECT_FALSE(again->erased);
  }
}

TEST_F(RedactStoreTest, OnlyLooksIfItIsADryRun) {
  make();
  const auto secrets = pieces();
  StoreRedactionJob dry = job();
  dry.is_dry_run = true;
  const auto report = redact_store(dry);
  ASSERT_OK(report);
  EXPECT_EQ(report->total().redacted, 4u);
  EXPECT_TRUE(is_in_any_file(secrets));
  EXPECT_EQ(all()[1], snapshot(1));
  EXPECT_FALSE(std::filesystem::exists(store_ / "erasures"));
}

TEST_F(RedactStoreTest, FinishesWhatAKilledRunBegan) {
  make();
  const uint64_t bytes_before = *directory_bytes(store_);
  const auto secrets = pieces();
  StoreRedactionJob killed = job();
  killed.code_anew = [](const auto&, const auto&, const auto&, const auto&) -> Result<Erasures> {
    return cancelled("killed");
  };
  EXPECT_EQ(redact_store(killed).status().code(), StatusCode::kCancelled);
  // Every answer is redacted, but the originals are still there.
  expect_redacted();
  EXPECT_TRUE(is_in_any_file(secrets));
  EXPECT_EQ(*pending_redactions(store_), 4u);
  const auto report = redact_store(job());
  ASSERT_OK(report);
  EXPECT_EQ(*pending_redactions(store_), 0u);
  EXPECT_EQ(report->taken_up, 4u);
  EXPECT_EQ(report->total().looked_at, 12u);
  EXPECT_EQ(report->total().redacted, 4u);
  EXPECT_EQ(report->total().boxes, 4u);
  EXPECT_EQ(report->bytes_before, bytes_before);
  expect_redacted();
  EXPECT_FALSE(is_in_any_file(secrets));
}

TEST_F(RedactStoreTest, CountsTheSameWhereverARunIsKilled) {
  make();
  const auto summary = [this] { return *(*StoreReader::open(store_))->summary(camera()); };
  const EntitySummary before = summary();
  const auto expect_counted = [&] {
    EXPECT_EQ(summary().forgotten.snapshots, 4u);
    EXPECT_EQ(summary().offered, before.offered + 4);
    EXPECT_EQ(summary().raw_bytes, before.raw_bytes);
    EXPECT_EQ(summary().offered_bytes, before.offered_bytes + before.raw_bytes / 3);
  };
  StoreRedactionJob killed = job();
  killed.code_anew = [](const auto&, const auto&, const auto&, const auto&) -> Result<Erasures> {
    return cancelled("killed");
  };
  EXPECT_EQ(redact_store(killed).status().code(), StatusCode::kCancelled);
  std::string noted;
  StoreRedactionJob rest = job();
  rest.code_anew = [&](const auto&, const auto&, const auto&, const auto&) -> Result<Erasures> {
    noted = as_text(read_file(store_ / "erasures/redaction.pending")->bytes());
    return Erasures();
  };
  const auto report = redact_store(rest);
  ASSERT_OK(report);
  EXPECT_EQ(report->erased->entities.at(camera()).erased, 4u);
  expect_counted();
  // One that is killed just ahead of its end leaves the sums that it meant to count.
  const std::string list = R"("counting":[4,)" + std::to_string(before.raw_bytes / 3) + "],";
  noted.insert(noted.find(R"("redacted")"), list);
  std::ofstream(store_ / "erasures/redaction.pending") << noted;
  ASSERT_OK(redact_store(job()));
  expect_counted();
}

TEST_F(RedactStoreTest, LeavesOutWhatWasNotedButNeverRecordedAnew) {
  make();
  StoreRedactionJob first = job();
  first.code_anew = [](const auto&, const auto&, const auto&, const auto&) -> Result<Erasures> {
    return cancelled("killed");
  };
  EXPECT_FALSE(redact_store(first).ok());
  // As if it had been killed between the note of one more snapshot and its new form.
  const std::filesystem::path file = store_ / "erasures/redaction.pending";
  std::string noted(as_text(read_file(file)->bytes()));
  const std::string list = R"("redacted":[)";
  noted.insert(noted.find(list) + list.size(), fmt::format("[{},9,false,1],", to_ns(time(0))));
  std::ofstream(file) << noted;
  EXPECT_EQ(*pending_redactions(store_), 5u);
  const auto report = redact_store(job());
  ASSERT_OK(report);
  EXPECT_EQ(report->taken_up, 4u);
  EXPECT_EQ(report->total().redacted, 4u);
  EXPECT_EQ(report->total().boxes, 4u);
  EXPECT_EQ(report->erased->entities.at(camera()).erased, 4u);
  EXPECT_EQ((*(*StoreReader::open(store_))->summary(camera())).forgotten.snapshots, 4u);
  expect_redacted();
}

TEST_F(RedactStoreTest, GoesOnWithTheBoxesThatHeldWhenItWasStopped) {
  // What the detector finds is in the first one only.
  make("png", 4, [](int index) { return index == 0 ? snapshot(1) : unmarked(index); });
  StoreRedactionJob stopped = job();
  stopped.options.hold = std::chrono::seconds(2);
  stopped.max_appended_bytes = 1;
  for (const int looked_at : {1, 2}) {
    std::stop_source stop;
    StoreRedactionJob one = stopped;
    one.stop = stop.get_token();
    one.progress = [&](const Progress& progress) {
      if (progress.done == static_cast<uint64_t>(looked_at - 1)) stop.request_stop();
    };
    EXPECT_EQ(redact_store(one).status().code(), StatusCode::kCancelled);
    EXPECT_EQ(*pending_redactions(store_), static_cast<uint64_t>(looked_at));
  }
  const auto report = redact_store(stopped);
  ASSERT_OK(report);
  EXPECT_EQ(report->taken_up, 2u);
  EXPECT_EQ(report->total().redacted, 3u) << "the fourth is beyond the hold";
  EXPECT_EQ(report->total().boxes, 1u);
  const std::vector<Snapshot> read = all();
  ASSERT_EQ(read.size(), 4u);
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(
        has_secret(read[static_cast<size_t>(i)].instances[0].data.at("image")->get<idf::NdArray>()),
        i == 3);
}

TEST_F(RedactStoreTest, RefusesADamagedNoteOfWhatIsPending) {
  make();
  std::filesystem::create_directories(store_ / "erasures");
  const std::string entity = R"({"first_segment": 1, "bytes_before": 1, "entities": {"A/b/c/d": )";
  const auto list = [](const std::string& redacted, const std::string& dropped,
                       const std::string& made, const std::string& held) {
    return fmt::format(R"({{"redacted": [{}], "dropped": [{}], "made": [{}], "held": [{}]}})",
                       redacted, dropped, made, held);
  };
  std::ofstream(store_ / "erasures/redaction.pending")
      << entity + list("[1, 1, true, 1]", "[2, 1]", "3", R"([1, 0, "", 0, 0, 0, 1, 1])") + "}}";
  EXPECT_EQ(*pending_redactions(store_), 2u) << "else the faults below would prove nothing";
  for (const std::string& text :
       {std::string(), std::string("[]"), std::string("{"),
        std::string(R"({"first_segment": 1, "bytes_before": 1})"),
        std::string(R"({"first_segment": -1, "bytes_before": 1, "entities": {}})"),
        std::string(R"({"first_segment": 1, "bytes_before": 1, "entities": {"Vision": {}}})"),
        entity + "[]}}", entity + list("[1.5, 1, true, 1]", "", "", "") + "}}",
        entity + list("[1, 1, true]", "", "", "") + "}}", entity + list("", "1", "", "") + "}}",
        entity + list("", "", R"("x")", "") + "}}",
        entity + list("", "", "", R"([1, 0, "", 0, 0, 0, 2, 1])") + "}}",
        entity + list("", "", "", R"([1, 0, "?", 0, 0, 0, 1, 1])") + "}}"}) {
    std::ofstream(store_ / "erasures/redaction.pending", std::ios::trunc) << text;
    EXPECT_EQ(redact_store(job()).status().code(), StatusCode::kDataLoss) << text;
  }
}

TEST_F(RedactStoreTest, ForgetsSnapshotsIfThatIsTheAction) {
  make();
  const auto secrets = pieces();
  StoreRedactionJob dropping = job();
  dropping.options.action = RedactAction::kDrop;
  const auto report = redact_store(dropping);
  ASSERT_OK(report);
  EXPECT_EQ(report->total().dropped, 4u);
  EXPECT_EQ(all().size(), 8u);
  EXPECT_FALSE(is_in_any_file(secrets));
}

TEST_F(RedactStoreTest, CountsForgottenSnapshotsOnceWhereverARunIsKilled) {
  make();
  StoreRedactionJob killed = job();
  killed.options.action = RedactAction::kDrop;
  killed.code_anew = [](const auto&, const auto&, const auto&, const auto&) -> Result<Erasures> {
    return cancelled("killed");
  };
  EXPECT_EQ(redact_store(killed).status().code(), StatusCode::kCancelled);
  std::string noted;
  StoreRedactionJob rest = killed;
  // What goes stays so, whatever the action of the run that finishes it.
  rest.options.action = RedactAction::kFill;
  rest.code_anew = [&](const auto&, const auto&, const auto&, const auto&) -> Result<Erasures> {
    noted = as_text(read_file(store_ / "erasures/redaction.pending")->bytes());
    return Erasures();
  };
  const auto expect_counted = [](const Result<StoreRedaction>& report) {
    ASSERT_OK(report);
    EXPECT_EQ(report->taken_up, 4u);
    EXPECT_EQ(report->total().dropped, 4u);
    EXPECT_EQ(report->total().redacted, 0u);
    EXPECT_EQ(report->total().boxes, 4u);
    EXPECT_EQ(report->erased->entities.at(camera()).erased, 4u);
  };
  expect_counted(redact_store(rest));
  EXPECT_EQ(all().size(), 8u);
  // One that is killed just ahead of its end has forgotten them already.
  std::ofstream(store_ / "erasures/redaction.pending") << noted;
  expect_counted(redact_store(rest));
}

TEST_F(RedactStoreTest, LeavesWhatHasNoAnswerAsItIs) {
  make();
  StoreRedactionJob silent = job();
  silent.options = marker_redaction(scratch_.path(), "silent");
  const auto report = redact_store(silent);
  ASSERT_OK(report);
  EXPECT_EQ(report->total().unanswered, 4u);
  EXPECT_EQ(report->total().redacted, 0u);
  for (int i = 0; i < kCount; ++i) EXPECT_EQ(all()[static_cast<size_t>(i)], snapshot(i));
}

TEST_F(RedactStoreTest, WaitsForADetectorThatDiesAndLooksAtAllOthers) {
  make("png", kCount, [](int index) { return index == 1 ? snapshot(1) : snapshot(0); });
  StoreRedactionJob dying = job();
  dying.options = marker_redaction(scratch_.path(), "dies");
  const auto report = redact_store(dying);
  ASSERT_OK(report);
  EXPECT_EQ(report->total().unanswered, 1u);
}

TEST_F(RedactStoreTest, LooksOnlyAtWhatIsNamed) {
  make();
  StoreRedactionJob part = job();
  part.targets = {"Vision @ until:" + to_string(time(3))};
  const auto report = redact_store(part);
  ASSERT_OK(report);
  EXPECT_EQ(report->total().looked_at, 4u);
  EXPECT_EQ(report->total().redacted, 1u);
  EXPECT_EQ(all()[4], snapshot(4));
  part.targets = {"Nothing/a/b/c"};
  EXPECT_EQ(redact_store(part).status().code(), StatusCode::kNotFound);
}

TEST_F(RedactStoreTest, TakesAugmentedSnapshotsAlongThatWereMadeOfIt) {
  make();
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (const int origin : {0, 1}) {
      Snapshot made = snapshot(0);
      made.entity = *MemoryId::parse("Vision/RGB/head/changed");
      made.time = time(origin);
      made.instances[0].metadata.origin = camera().at(time(origin)).instance(0);
      made.instances[0].metadata.recipe = "{}";
      ASSERT_OK(writer->append({pack_snapshot(made)}, nullptr));
    }
    ASSERT_OK(writer->seal());
  }
  std::string noted;
  StoreRedactionJob noting = job();
  noting.code_anew = [&](const auto&, const auto&, const auto&, const auto&) -> Result<Erasures> {
    noted = as_text(read_file(store_ / "erasures/redaction.pending")->bytes());
    return Erasures();
  };
  const auto report = redact_store(noting);
  ASSERT_OK(report);
  EXPECT_EQ(report->made_of, 1u);
  const auto summary =
      (*StoreReader::open(store_))->summary(*MemoryId::parse("Vision/RGB/head/changed"));
  ASSERT_OK(summary);
  EXPECT_EQ(summary->snapshots, 1u);
  // One that is killed just ahead of its end finds them gone.
  std::ofstream(store_ / "erasures/redaction.pending") << noted;
  EXPECT_EQ(redact_store(job())->made_of, 1u);
}

TEST_F(RedactStoreTest, IsRefusedWhileSomebodyRecords) {
  make();
  const auto writer = *StoreWriter::open(store_, {});
  EXPECT_EQ(redact_store(job()).status().code(), StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace engram::ltm
