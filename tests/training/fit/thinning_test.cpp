// SPDX-License-Identifier: Apache-2.0
#include "training/fit/thinning.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "training/fit/windows.h"

namespace engram::training {
namespace {

size_t rows_of(const std::vector<SnapshotRun>& runs) {
  size_t rows = 0;
  for (const SnapshotRun& run : runs) rows += run.rows.size();
  return rows;
}

TEST(Thinning, KeepsWholeRecordingsThatFit) {
  EXPECT_EQ(thinned({{0, 20}, {20, 60}}, 60).read,
            (std::vector<SnapshotRun>{{{0, 20}, 17}, {{20, 60}, 54}}));
}

TEST(Thinning, HoldsOutTheEndsOfRecordingsAndNotOfRuns) {
  const std::vector<Sequence> recordings{{0, 1000}, {1000, 1400}};
  const std::vector<SnapshotRun> runs = thinned(recordings, 350).read;
  EXPECT_LE(rows_of(runs), 350u);
  EXPECT_GE(rows_of(runs), 280u);
  size_t held_out = 0;
  for (const auto& [rows, first_held_out] : runs) {
    const Sequence& recording = recordings[rows.first < 1000 ? 0 : 1];
    EXPECT_LE(rows.end, recording.end);
    EXPECT_LE(rows.size(), 32u);
    // A run is of one kind: what comes after what is held out is not trained on.
    const bool is_held_out = rows.first >= held_out_from(recording);
    EXPECT_EQ(first_held_out, is_held_out ? rows.first : rows.end);
    EXPECT_TRUE(is_held_out || rows.end <= held_out_from(recording));
    held_out += is_held_out ? rows.size() : 0;
  }
  EXPECT_GT(held_out, 0u);
  EXPECT_GT(runs.back().rows.first, 1000u);
}

TEST(Thinning, SpacesRunsEvenlyOverShortRecordings) {
  std::vector<Sequence> recordings;
  for (size_t i = 0; i < 100; ++i) recordings.push_back({20 * i, 20 * (i + 1)});
  const std::vector<SnapshotRun> runs = thinned(recordings, 500).read;
  EXPECT_LE(rows_of(runs), 500u);
  EXPECT_GE(rows_of(runs), 450u);
  for (size_t i = 1; i < runs.size(); ++i)
    EXPECT_LE(runs[i].rows.first - runs[i - 1].rows.first, 80u);
}

TEST(Thinning, TellsWhatOfTrainingIsLeftOut) {
  const std::vector<Sequence> recordings{{0, 1000}, {1000, 1400}};
  const ThinnedRuns runs = thinned(recordings, 350);
  std::vector<Sequence> all = runs.left_out;
  for (const auto& [rows, first_held_out] : runs.read)
    if (first_held_out == rows.end) all.push_back(rows);
  std::ranges::sort(all, {}, &Sequence::first);
  // Together they are what is trained on, without a gap.
  for (size_t i = 1; i < all.size(); ++i)
    EXPECT_EQ(all[i].first, all[i - 1].end == held_out_from(recordings[0]) ? 1000 : all[i - 1].end);
  EXPECT_EQ(all.front().first, 0u);
  EXPECT_EQ(all.back().end, held_out_from(recordings[1]));
  EXPECT_TRUE(thinned(recordings, 1400).left_out.empty());
}

TEST(Thinning, KeepsAWindowOfEachKindHoweverLittleFits) {
  const std::vector<SnapshotRun> runs = thinned({{0, 200}}, 5).read;
  EXPECT_EQ(runs, (std::vector<SnapshotRun>{{{0, 3}, 3}, {{170, 173}, 170}}));
}

}  // namespace
}  // namespace engram::training
