// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/make_saliency.h"

#include <cmath>

#include "ltm/core/file.h"
#include "ltm/recall/access_log.h"
#include "ltm/saliency/pending_saliency.h"
#include "ltm/saliency/saliency_table.h"
#include "ltm/saliency/why_salient.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/segment_index.h"
#include "tests/ltm/saliency/robot_day.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/full_store.h"

namespace engram::ltm {
namespace {

using ::testing::HasSubstr;

class MakeSaliencyTest : public ::testing::Test {
 protected:
  MakeSaliencyTest() : store_(scratch_ / "store") {
    EXPECT_OK(create_store(store_));
    record_day(store_, 0, 200);
  }

  Result<SaliencyReport> make(const SaliencyOptions& options = {}) {
    return make_saliency(store_, {}, options, {}, {});
  }

  [[nodiscard]] SaliencyTable table() const {
    const auto reader = StoreReader::open(store_);
    EXPECT_OK(reader);
    return SaliencyTable::read(**reader, read_accesses(store_));
  }

  Result<SalientMoment> why(const MemoryId& entity, std::optional<int64_t> step) {
    return why_salient(store_, {}, entity,
                       step ? std::optional(example_time(*step)) : std::nullopt);
  }

  static SalientPart part(const SalientMoment& moment, SaliencyPart which) {
    return *std::ranges::find(moment.parts, which, &SalientPart::part);
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

TEST_F(MakeSaliencyTest, WhatHappensIsWorthMoreThanWhatRests) {
  const auto made = make();
  ASSERT_OK(made);
  EXPECT_EQ(made->snapshots, 206u);
  EXPECT_EQ(made->entities, 3u);
  const SaliencyTable all = table();
  EXPECT_EQ(all.size(), 206u);
  const auto cup = [&](int64_t step) { return *all.find(cup_entity(), example_time(step)); };
  for (const int64_t rests : {30, 60, 90, 130, 190}) {
    EXPECT_LT(cup(rests), 0.2) << rests;
    EXPECT_GT(cup(kMovesFrom), cup(rests)) << rests;
    EXPECT_GT(cup(110), cup(rests)) << rests;
    EXPECT_GT(*all.find(skill_entity(), example_time(60)), cup(rests)) << rests;
    EXPECT_GT(*all.find(words_entity(), example_time(95)), cup(rests)) << rests;
  }
  EXPECT_GT(*all.find(skill_entity(), example_time(60)),
            *all.find(skill_entity(), example_time(40)));
  EXPECT_FALSE(all.find(cup_entity(), example_time(1000)));
  EXPECT_FALSE(all.find(example_entity(), example_time(0)));
}

TEST_F(MakeSaliencyTest, ATenthOfTheDayTellsWhereTheCupWas) {
  ASSERT_OK(make());
  const SaliencyTable all = table();
  const SaliencyCut cut = all.cut_for(EntityPattern(), 0.15);
  size_t kept = 0;
  double last = 0, worst = 0;
  for (int64_t i = 0; i < 200; ++i) {
    if (!cut.takes(*all.find(cup_entity(), example_time(i)), example_time(i))) {
      ++kept;
      last = cup_x(i);
    }
    worst = std::max(worst, std::abs(cup_x(i) - last));
  }
  EXPECT_LE(kept, 31u);
  EXPECT_LE(worst, 0.11);
}

TEST_F(MakeSaliencyTest, TheShareThatStaysIsTheOneThatWasAskedFor) {
  ASSERT_OK(make());
  const SaliencyTable all = table();
  for (const double share : {0.0, 0.1, 0.5, 1.0}) {
    const SaliencyCut cut = all.cut_for(EntityPattern(), share);
    int stays = 0;
    for (const int64_t i : {35, 95})
      stays += cut.takes(*all.find(words_entity(), example_time(i)), example_time(i)) ? 0 : 1;
    for (const int64_t i : {40, 60, 100, 120})
      stays += cut.takes(*all.find(skill_entity(), example_time(i)), example_time(i)) ? 0 : 1;
    for (int64_t i = 0; i < 200; ++i)
      stays += cut.takes(*all.find(cup_entity(), example_time(i)), example_time(i)) ? 0 : 1;
    EXPECT_NEAR(stays, share * 206, 8) << share;
  }
}

TEST_F(MakeSaliencyTest, OnlyWhatIsNewIsCalculatedInTheNextNight) {
  ASSERT_OK(make());
  EXPECT_EQ(make()->snapshots, 0u);
  record_day(store_, 200, 260);
  const auto second = make();
  ASSERT_OK(second);
  EXPECT_EQ(second->snapshots, 60u);
  EXPECT_EQ(table().size(), 266u);
  // The cup rests still, so its first snapshot of the new part tells nothing.
  EXPECT_LT(*table().find(cup_entity(), example_time(200)), 0.2);
}

TEST_F(MakeSaliencyTest, EndsWhenTheTimeIsOverAndGoesOn) {
  SaliencyOptions options;
  int asked = 0;
  options.is_over = [&asked] { return ++asked > 50; };
  const auto part = make(options);
  ASSERT_OK(part);
  EXPECT_LT(part->snapshots, 60u);
  EXPECT_GT(part->snapshots, 0u);
  ASSERT_OK(make());
  EXPECT_EQ(table().size(), 206u);
  std::stop_source stop;
  stop.request_stop();
  record_day(store_, 200, 260);
  EXPECT_EQ(make_saliency(store_, {}, {}, {}, stop.get_token()).status().code(),
            StatusCode::kCancelled);
}

TEST_F(MakeSaliencyTest, GoesWithWhatIsForgottenAndDamageIsNoLoss) {
  ASSERT_OK(make());
  ForgetSet gone;
  for (int64_t i = 0; i < 100; ++i) gone[cup_entity()].insert(example_time(i));
  ASSERT_OK(forget_snapshots(store_, gone));
  EXPECT_FALSE(table().find(cup_entity(), example_time(50)));
  ASSERT_OK(make());
  EXPECT_EQ(table().size(), 106u);
  const auto reader = *StoreReader::open(store_);
  const std::string index =
      segment_index_name(reader->manifest().segments.front().file, kSaliencyIndex);
  ASSERT_OK(replace_file(store_ / index, as_bytes("damaged")));
  EXPECT_EQ(table().size(), 0u);
  ASSERT_OK(make());
  EXPECT_EQ(table().size(), 106u);
}

TEST_F(MakeSaliencyTest, WhatStaysKeepsItsWorthWhenOthersGo) {
  ASSERT_OK(make());
  const SaliencyTable before = table();
  const KeptSaliency kept = *KeptSaliency::read(store_);
  ForgetSet gone;
  for (int64_t i = 90; i < 110; ++i) gone[cup_entity()].insert(example_time(i));
  ASSERT_OK(forget_snapshots(store_, gone));
  EXPECT_EQ(table().size(), 0u);
  ASSERT_OK(kept.restore(store_));
  const SaliencyTable after = table();
  EXPECT_EQ(after.size(), 186u);
  for (const int64_t i : {0, 89, 110, 119, 199})
    EXPECT_EQ(after.find(cup_entity(), example_time(i)),
              before.find(cup_entity(), example_time(i)));
  EXPECT_FALSE(after.find(cup_entity(), example_time(100)));
  EXPECT_EQ(make()->snapshots, 0u);
}

TEST_F(MakeSaliencyTest, OfErasedEntitiesNothingCalculatedIsLeft) {
  ASSERT_OK(make());
  ASSERT_OK(make_saliency_stale(store_, {cup_entity()}));
  EXPECT_EQ(table().size(), 6u);
  EXPECT_TRUE(table().find(words_entity(), example_time(35)));
  EXPECT_EQ(make()->snapshots, 200u);
}

TEST_F(MakeSaliencyTest, AShareThatStaysIsCutOnce) {
  ASSERT_OK(make());
  const auto forget_all_but = [&](double share) {
    const SaliencyTable all = table();
    const SaliencyCut cut = all.cut_for(EntityPattern(), share);
    ForgetSet gone;
    for (int64_t i = 0; i < 400; ++i)
      for (const MemoryId& entity : {cup_entity(), skill_entity(), words_entity()})
        if (const auto found = all.find(entity, example_time(i)))
          if (cut.takes(*found, example_time(i))) gone[entity].insert(example_time(i));
    const auto kept = KeptSaliency::read(store_);
    ASSERT_OK(kept);
    ASSERT_OK(forget_snapshots(store_, gone));
    ASSERT_OK(kept->restore(store_));
  };
  forget_all_but(0.2);
  const size_t left = table().size();
  EXPECT_NEAR(left, 41, 2);
  for (int night = 0; night < 3; ++night) forget_all_but(0.2);
  EXPECT_EQ(table().size(), left);
  // Joined segments and erased neighbours change nothing of it.
  const auto kept = KeptSaliency::read(store_);
  ASSERT_OK(kept);
  ASSERT_OK(compact(store_, {}));
  ASSERT_OK(kept->restore(store_));
  ASSERT_OK(make_saliency_stale(store_, {cup_entity()}));
  EXPECT_LT(table().size(), 10u);
  ASSERT_OK(make());
  forget_all_but(0.2);
  EXPECT_EQ(table().size(), left);
  // Of what is new another fifth stays.
  record_day(store_, 200, 400);
  ASSERT_OK(make());
  forget_all_but(0.2);
  EXPECT_NEAR(table().size(), 81, 3);
}

TEST_F(MakeSaliencyTest, ALaterNightMeasuresChangeAsOneNightWould) {
  // The cup swings all day.
  const auto path = scratch_ / "swings";
  const auto record = [&](const std::filesystem::path& store, int64_t first, int64_t end) {
    const auto writer = StoreWriter::open(store, {.durability = Durability::kNone});
    ASSERT_OK(writer);
    for (int64_t i = first; i < end; ++i) {
      const std::vector<double> position{std::sin(static_cast<double>(i) * 0.7), 0};
      Snapshot snapshot{cup_entity(), example_time(i), {}};
      snapshot.instances.push_back(
          {idf::Dict{{"position", idf::NdArray::take({2}, position)}}, example_metadata(i)});
      ASSERT_OK((*writer)->append({pack_snapshot(snapshot)}, nullptr));
    }
    ASSERT_OK((*writer)->seal());
  };
  const auto mean_change = [](const std::filesystem::path& store) {
    const auto reader = StoreReader::open(store);
    EXPECT_OK(reader);
    const EntitySaliency all = stored_saliency_of(**reader, cup_entity());
    double sum = 0;
    for (size_t i = 3000; i < 3020; ++i)
      sum += parts_of(all.rows[i].parts, 0)[SaliencyPart::kChange] / 20;
    return sum;
  };
  std::vector<double> changes;
  for (const bool has_nights : {false, true}) {
    const auto store = path / (has_nights ? "nights" : "night");
    ASSERT_OK(create_store(store));
    record(store, 0, has_nights ? 3000 : 3020);
    ASSERT_OK(make_saliency(store, {}, {}, {}, {}));
    if (has_nights) record(store, 3000, 3020);
    ASSERT_OK(make_saliency(store, {}, {}, {}, {}));
    changes.push_back(mean_change(store));
  }
  EXPECT_NEAR(changes[1], changes[0], 0.05);
}

TEST_F(MakeSaliencyTest, ALayoutThatComesBackIsNotNew) {
  {
    const auto writer = StoreWriter::open(store_, {.durability = Durability::kNone});
    ASSERT_OK(writer);
    for (int64_t i = 0; i < 60; ++i) {
      Snapshot snapshot{example_entity("turns"), example_time(i), {}};
      idf::Dict value{{"x", i < 50 ? 1.0 : 2.0 + static_cast<double>(i)}};
      if (i % 2 == 1) value.append_unique("y", 3.0);
      snapshot.instances.push_back({std::move(value), example_metadata(i)});
      ASSERT_OK((*writer)->append({pack_snapshot(snapshot)}, nullptr));
    }
    ASSERT_OK((*writer)->seal());
  }
  ASSERT_OK(make());
  const auto reader = *StoreReader::open(store_);
  const EntitySaliency all = stored_saliency_of(*reader, example_entity("turns"));
  const auto novelty = [&](size_t i) {
    return parts_of(all.rows[i].parts, 0)[SaliencyPart::kNovelty];
  };
  EXPECT_EQ(novelty(0), 1);
  EXPECT_EQ(novelty(1), 1);  // Another layout.
  for (size_t i = 2; i < 50; ++i) EXPECT_EQ(novelty(i), 0) << i;
  EXPECT_GT(novelty(50), 0.1);
}

TEST_F(MakeSaliencyTest, OneDamagedSnapshotIsLookedAtOnce) {
  ASSERT_OK(make());
  record_day(store_, 200, 260);
  const auto unreadable = [&]() -> size_t {
    const auto reader = StoreReader::open(store_);
    if (!reader.ok()) return 0;
    const auto entries = entries_of(**reader, cup_entity());
    if (!entries.ok() || entries->size() != 260) return 0;
    return static_cast<size_t>(std::ranges::count_if(*entries, [&](const SnapshotEntry& entry) {
      return (*reader)->read_values(cup_entity(), entry).status().code() == StatusCode::kDataLoss;
    }));
  };
  const auto file = store_ / (*StoreReader::open(store_))->manifest().segments.back().file;
  const uint64_t bits = std::filesystem::file_size(file) * 8;
  for (uint64_t bit = 3; bit < bits && unreadable() == 0; bit += 32) {
    flip_bit(file, bit);
    if (unreadable() == 0) flip_bit(file, bit);
  }
  const size_t damaged = unreadable();
  ASSERT_GT(damaged, 0u);
  const auto second = make();
  ASSERT_OK(second);
  EXPECT_EQ(table().size(), 266u - damaged);
  EXPECT_EQ(make()->snapshots, 0u);
  // What comes behind it is all that the next night looks at.
  record_day(store_, 260, 270);
  EXPECT_EQ(make()->snapshots, 10u);
}

TEST_F(MakeSaliencyTest, WhatWasReadIsWorthMore) {
  ASSERT_OK(make());
  const double before = *table().find(cup_entity(), example_time(150));
  {
    AccessLog log(store_, {});
    for (int i = 0; i < 9; ++i) log.note(cup_entity(), example_time(150));
  }
  EXPECT_NEAR(*table().find(cup_entity(), example_time(150)) - before, 0.05 * 0.9, 1e-6);
}

TEST_F(MakeSaliencyTest, WeightsFollowWhatWasAskedFor) {
  ASSERT_OK(make());
  {
    AccessLog log(store_, {});  // Where the cup was while it was carried.
    for (int64_t i = kMovesFrom; i < kMovesUntil; ++i) log.note(cup_entity(), example_time(i));
  }
  EXPECT_EQ(make()->weights.learned_from, 0u);  // That is too little.
  record_day(store_, 1000, 1200);
  {
    AccessLog log(store_, {});
    for (int64_t i = 1000; i < 1040; ++i) log.note(cup_entity(), example_time(i));
  }
  const auto made = make();
  ASSERT_OK(made);
  EXPECT_EQ(made->weights.learned_from, 60u);
  EXPECT_NE(made->weights.parts, SaliencyWeights::standard().parts);
  EXPECT_EQ(stored_weights(store_).parts, made->weights.parts);
  EXPECT_EQ(why(cup_entity(), 110)->learned_from, 60u);
}

TEST_F(MakeSaliencyTest, ExplainsEachPart) {
  ASSERT_OK(make());
  const auto carried = why(cup_entity(), kMovesFrom);
  ASSERT_OK(carried);
  EXPECT_TRUE(carried->is_stored);
  EXPECT_EQ(carried->count, 200u);
  double sum = 0;
  for (const SalientPart& one : carried->parts) sum += one.contribution;
  EXPECT_NEAR(sum, carried->saliency, 1e-9);
  EXPECT_EQ(part(*carried, SaliencyPart::kLinks).value, 1);
  EXPECT_THAT(part(*carried, SaliencyPart::kSurprise).found, HasSubstr("texts or links changed"));
  const auto moves = why(cup_entity(), kMovesFrom + 1);
  ASSERT_OK(moves);
  EXPECT_THAT(part(*moves, SaliencyPart::kSurprise).found, HasSubstr("position[0] is 0.1"));
  EXPECT_THAT(part(*moves, SaliencyPart::kSurprise).expected, HasSubstr("0 (its last value held)"));
  EXPECT_THAT(part(*moves, SaliencyPart::kChange).found, HasSubstr("position[0]"));
  const auto failed = why(skill_entity(), 60);
  ASSERT_OK(failed);
  EXPECT_EQ(part(*failed, SaliencyPart::kOutcome).found, "failure");
  EXPECT_EQ(failed->parts.front().part, SaliencyPart::kChange);
  const auto said = why(words_entity(), {});
  ASSERT_OK(said);
  EXPECT_EQ(said->time, example_time(95));
  EXPECT_EQ(part(*said, SaliencyPart::kSpeech).value, 1);
}

TEST_F(MakeSaliencyTest, ExplainsWhatNoNightHasLookedAt) {
  const auto before = why(cup_entity(), 110);
  ASSERT_OK(before);
  EXPECT_FALSE(before->is_stored);
  ASSERT_OK(make());
  const auto after = why(cup_entity(), 110);
  ASSERT_OK(after);
  EXPECT_TRUE(after->is_stored);
  EXPECT_EQ(after->saliency, before->saliency);
  EXPECT_EQ(after->rank, before->rank);
}

TEST_F(MakeSaliencyTest, RefusesWhatIsNotThere) {
  EXPECT_EQ(why(example_entity(), 1).status().code(), StatusCode::kNotFound);
  const auto missing = why(cup_entity(), 100'000);
  EXPECT_EQ(missing.status().code(), StatusCode::kNotFound);
  EXPECT_THAT(missing.status().message(), HasSubstr("has no snapshot at"));
  EXPECT_EQ(why(*MemoryId::parse("Objects/Instances"), {}).status().code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(make_saliency(scratch_ / "none", {}, {}, {}, {}).status().code(),
            StatusCode::kNotFound);
}

}  // namespace
}  // namespace engram::ltm
