// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/stored_saliency.h"

#include "ltm/codec/zstd.h"
#include "ltm/core/byte_fields.h"
#include "ltm/saliency/learn_weights.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

SaliencyParts example_parts(int64_t i) {
  SaliencyParts parts;
  parts[SaliencyPart::kChange] = static_cast<double>(i % 7) / 7;
  parts[SaliencyPart::kSpeech] = i % 3 == 0 ? 1 : 0;
  parts[SaliencyPart::kNovelty] = 0.25;
  return parts;
}

EntitySaliency example_saliency(const std::string& name, int64_t count) {
  EntitySaliency saliency{example_entity(name), {}, {}};
  for (int64_t i = 0; i < count; ++i) {
    saliency.append(example_time(i),
                    {stored_parts(example_parts(i)), static_cast<uint32_t>(1 + i % 4),
                     i % 5 == 1 ? RowState::kDamaged : RowState::kKnown});
  }
  return saliency;
}

TEST(StoredSaliency, ComesBackAsItWasPacked) {
  const SegmentSaliency all{example_saliency("cam", 100), example_saliency("left", 0)};
  const auto read = unpack_saliency(pack_saliency(all));
  ASSERT_OK(read);
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ(read->front().entity, all.front().entity);
  EXPECT_EQ(read->front().times, all.front().times);
  EXPECT_EQ(read->front().rows, all.front().rows);
  const SaliencyParts parts = parts_of(read->front().rows[5].parts, 3);
  EXPECT_NEAR(parts[SaliencyPart::kChange], 5.0 / 7, 1e-4);
  EXPECT_EQ(parts[SaliencyPart::kReads], 0.75);
}

TEST(StoredSaliency, DamagedBytesAreRefused) {
  auto bytes = pack_saliency({example_saliency("cam", 100)});
  for (const size_t size : {size_t{0}, size_t{5}, bytes.size() - 1})
    EXPECT_EQ(unpack_saliency(std::span(bytes).first(size)).status().code(), StatusCode::kDataLoss);
  EntitySaliency backwards = example_saliency("cam", 3);
  std::swap(backwards.times[0], backwards.times[2]);
  EXPECT_EQ(unpack_saliency(pack_saliency({backwards})).status().code(), StatusCode::kDataLoss);
  EntitySaliency nothing = example_saliency("cam", 3);
  nothing.rows[1].stands_for = 0;
  EXPECT_EQ(unpack_saliency(pack_saliency({nothing})).status().code(), StatusCode::kDataLoss);
  EntitySaliency strange = example_saliency("cam", 3);
  strange.rows[1].state = static_cast<RowState>(7);
  EXPECT_EQ(unpack_saliency(pack_saliency({strange})).status().code(), StatusCode::kDataLoss);
}

TEST(StoredSaliency, WhatTheFirstVersionWroteIsRead) {
  const EntitySaliency one = example_saliency("cam", 3);
  std::vector<std::byte> bytes;
  FieldWriter fields(bytes);
  fields.number(uint32_t{1});
  fields.number(uint32_t{1});
  fields.text(one.entity.to_string());
  fields.number(uint64_t{3});
  for (const Time time : one.times) fields.number(to_ns(time));
  for (size_t part = 0; part < StoredParts().size(); ++part)
    for (const SaliencyRow& row : one.rows) fields.number(row.parts[part]);
  const auto read = unpack_saliency(compress_zstd(bytes));
  ASSERT_OK(read);
  ASSERT_EQ(read->front().rows.size(), 3u);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_EQ(read->front().rows[i], (SaliencyRow{one.rows[i].parts, 1, RowState::kKnown}));
}

TEST(StoredSaliency, WeightsComeBackAndWrongOnesAreRefused) {
  SaliencyWeights weights = SaliencyWeights::standard();
  weights.learned_from = 77;
  const auto read = unpack_weights(pack_weights(weights));
  ASSERT_OK(read);
  EXPECT_EQ(read->parts, weights.parts);
  EXPECT_EQ(read->learned_from, 77u);
  weights.parts[SaliencyPart::kChange] = 7;
  EXPECT_EQ(unpack_weights(pack_weights(weights)).status().code(), StatusCode::kDataLoss);
  EXPECT_EQ(unpack_weights({}).status().code(), StatusCode::kDataLoss);
}

TEST(WeightLearner, WhatWasAskedForCountsMore) {
  const EntitySaliency saliency = example_saliency("cam", 9000);
  WeightLearner learner;
  EXPECT_EQ(learner.learn().parts, SaliencyWeights::standard().parts);
  std::vector<bool> read;  // Speech is asked for, and nothing else.
  for (int64_t i = 0; i < 9000; ++i) read.push_back(example_parts(i)[SaliencyPart::kSpeech] > 0);
  learner.add(saliency, read);
  const SaliencyWeights learned = learner.learn();
  ASSERT_OK(learned.validate());
  EXPECT_EQ(learned.learned_from, 3000u);
  const SaliencyWeights standard = SaliencyWeights::standard();
  EXPECT_GT(learned.parts[SaliencyPart::kSpeech], 0.7);
  EXPECT_LT(learned.parts[SaliencyPart::kChange], standard.parts[SaliencyPart::kChange] / 2);
  EXPECT_EQ(learned.parts[SaliencyPart::kReads], standard.parts[SaliencyPart::kReads]);
}

TEST(WeightLearner, WhoeverReadsEverythingTeachesNothing) {
  const EntitySaliency saliency = example_saliency("cam", 5000);
  WeightLearner learner;
  learner.add(saliency, std::vector<bool>(5000, true));
  learner.add(saliency, std::vector<bool>(5000, false));
  EXPECT_EQ(learner.learn().learned_from, 0u);
  EXPECT_EQ(learner.learn().parts, SaliencyWeights::standard().parts);
}

}  // namespace
}  // namespace engram::ltm
