// SPDX-License-Identifier: Apache-2.0
#include "tests/faults/session.h"

#include <unistd.h>

#include <array>
#include <set>

#include "ltm/codec/seal_rules.h"
#include "ltm/core/file.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm::faults {

namespace {

constexpr int kPerRound = 6;
constexpr std::array<const char*, kSteps> kStepNames{"open",    "record",  "seal",
                                                     "declare", "publish", "drop recorded",
                                                     "compact", "forget"};
/// Images as groups, numbers as columns: all of it without loss.
SealRules seal_rules(const MemoryId& entity) {
  PackOptions options;
  if (entity == session_entity(0)) options.rules = {{"**", MediumKind::kNumber, "columns"}};
  if (entity == session_entity(1)) options.rules = {{"**", MediumKind::kImage, "ffv1:group=4"}};
  return *SealRules::create(options);
}

enum Step { kOpen, kRecord, kSeal, kDeclare, kPublish, kDrop, kCompact, kForget };

class Session {
 public:
  Session(std::filesystem::path store, const SessionOptions& options, const Tell& tell)
      : store_(std::move(store)), options_(options), tell_(tell) {
    options_.store.seal_rules = seal_rules;
  }

  void run() {
    begin(kOpen);
    if (!open()) return;
    for (int round = 0; round < options_.rounds; ++round) run_round(round);
    if (is_stopped_) return;
    // The next writer takes over what this one leaves unsealed.
    begin(kOpen);
    record(3);
    if (is_stopped_ || !open()) return;
    record(2);
    tell_({Told::kFinished, 0, 0, 0});
  }

 private:
  void begin(Step step) { tell_({Told::kStep, step, 0, 0}); }

  bool succeeds(const Status& status) {
    if (!status.ok()) tell_({Told::kFailed, static_cast<int32_t>(status.code()), 0, 0});
    return status.ok();
  }

  /// Opens the store for writing; a second try where the first fails.
  bool open() {
    writer_.reset();
    for (int attempt = 0; attempt < 2; ++attempt) {
      if (is_store_absent(store_) && !succeeds(create_store(store_))) continue;
      auto opened = StoreWriter::open(store_, options_.store);
      if (!succeeds(opened.status())) continue;
      writer_ = std::move(opened).value();
      return true;
    }
    is_stopped_ = true;
    return false;
  }

  bool append(const std::vector<PackedSnapshot>& snapshots) {
    for (int attempt = 0; attempt < 2; ++attempt) {
      if (succeeds(writer_->append(snapshots, nullptr))) return true;
      if (!open()) return false;
    }
    return false;
  }

  void store(int64_t index, int64_t version) {
    if (is_stopped_) return;
    std::vector<PackedSnapshot> commit;
    for (int entity = 0; entity < kEntities; ++entity)
      commit.push_back(pack_snapshot(session_snapshot(entity, index, version)));
    if (append(commit))
      for (int entity = 0; entity < kEntities; ++entity)
        tell_({Told::kStored, entity, index, version});
    if (options_.pause_us > 0) ::usleep(static_cast<useconds_t>(options_.pause_us));
  }

  void record(int count) {
    begin(kRecord);
    for (int i = 0; i < count; ++i) store(next_++, 0);
  }

  void seal() {
    begin(kSeal);
    if (!succeeds(writer_->seal())) succeeds(writer_->seal());
  }

  void declare(int round) {
    begin(kDeclare);
    const int number = round % kDeclaredSegments;
    if (succeeds(writer_->declare(declared_segment(number), idf::Type::dict(idf::Type::string()))))
      tell_({Told::kDeclared, number, 0, 0});
  }

  /// Latents for what is sealed of the first entity, and no recorded forms any more.
  void consolidate(int64_t end) {
    begin(kPublish);
    const MemoryId entity = session_entity(0);
    if (!succeeds(publish(entity, end))) return;
    begin(kDrop);
    tell_({Told::kDropping, 0, 0, 0});
    const Status dropped = drop_recorded(store_, entity, {}).status();
    if (!succeeds(dropped)) succeeds(drop_recorded(store_, entity, {}).status());
  }

  Status publish(const MemoryId& entity, int64_t end) {
    ENGRAM_ASSIGN_OR_RETURN(const Manifest manifest, read_manifest(store_));
    const int version = next_model_version(manifest, entity);
    ENGRAM_ASSIGN_OR_RETURN(const auto file, temporary_file(store_, ".model"));
    ENGRAM_RETURN_IF_ERROR(replace_file(file, as_bytes("weights " + std::to_string(version))));
    // A job encodes what is there: nothing that was forgotten.
    std::vector<LatentSnapshot> latents = example_latents(options_.first, end, version);
    std::erase_if(latents, [this](const LatentSnapshot& latent) {
      return forgotten_.contains(latent.time);
    });
    return publish_model(store_, entity, version, file, latents);
  }

  void compact_segments() {
    begin(kCompact);
    const CompactOptions options{.segment_snapshots = 60};
    if (!succeeds(compact(store_, options).status())) succeeds(compact(store_, options).status());
  }

  /// One that two rounds ago was sealed, and updated where it ever was.
  void forget_one() {
    const int64_t index = next_ - 3 * kPerRound;
    if (index < options_.first) return;
    begin(kForget);
    const int number = static_cast<int>(index % kEntities);
    tell_({Told::kForgetting, number, index, 0});
    if (number == 0) forgotten_.insert(example_time(index));
    const ForgetSet gone{{session_entity(number), {example_time(index)}}};
    if (succeeds(forget_snapshots(store_, gone).status()) ||
        succeeds(forget_snapshots(store_, gone).status()))
      tell_({Told::kForgotten, number, index, 0});
  }

  void run_round(int round) {
    record(kPerRound);
    if (is_stopped_) return;
    seal();
    record(kPerRound / 2);
    store(next_ - kPerRound, 1);  // An update of what is sealed already.
    if (is_stopped_) return;
    declare(round);
    const int64_t sealed = next_;
    record(2);
    if (is_stopped_) return;
    if ((round + 1) % options_.consolidate_every == 0) {
      consolidate(sealed);
      compact_segments();
    }
    forget_one();
  }

  std::filesystem::path store_;
  SessionOptions options_;
  const Tell& tell_;
  std::unique_ptr<StoreWriter> writer_;
  int64_t next_ = options_.first;
  std::set<Time> forgotten_;  ///< Of the first entity.
  bool is_stopped_ = false;
};

}  // namespace

MemoryId session_entity(int number) {
  return example_entity(number == 0 ? "numbers" : "images");
}

MemoryId declared_segment(int number) {
  return *MemoryId::from_names({"Typed", "segment " + std::to_string(number)});
}

Snapshot session_snapshot(int entity, int64_t index, int64_t version) {
  Snapshot snapshot = example_snapshot(session_entity(entity), index);
  auto* value = snapshot.instances.front().data.get_if<idf::Dict>();
  value->set("version", version);
  if (entity == 1) value->set("image", example_image(12, 16, 3, index + version));
  return snapshot;
}

const char* step_name(int step) {
  return kStepNames[static_cast<size_t>(step)];
}

void run_session(const std::filesystem::path& store, const SessionOptions& options,
                 const Tell& tell) {
  Session(store, options, tell).run();
}

}  // namespace engram::ltm::faults
