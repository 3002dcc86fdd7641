// SPDX-License-Identifier: Apache-2.0
// How long chains may be, so that any moment is reached in time.
#include "training/night/access_rows.h"

#include <gtest/gtest.h>

#include "tests/training/recorded_scene.h"
#include "training/night/consolidate.h"
#include "training/night/night_history.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::kSquare;
using engram::testing::night;
using engram::testing::quick_consolidation;
using engram::testing::record;
using engram::testing::ScratchPath;
using std::chrono::milliseconds;

TEST(AccessRows, LeaveAQuarterOfTheTime) {
  EXPECT_EQ(rows_within(milliseconds(50), {.once = 0, .per_row = 1e-3}), 32);
  EXPECT_EQ(rows_within(milliseconds(50), {.once = 0.02, .per_row = 1e-3}), 16);
  EXPECT_EQ(rows_within(milliseconds(43), {.once = 0, .per_row = 1e-3}), 32);
  EXPECT_EQ(rows_within(milliseconds(42), {.once = 0, .per_row = 1e-3}), 24);
}

TEST(AccessRows, HaveBounds) {
  EXPECT_EQ(rows_within(milliseconds(50), {.once = 0, .per_row = 1}), 8);
  EXPECT_EQ(rows_within(milliseconds(50), {.once = 1, .per_row = 1e-6}), 8);
  EXPECT_EQ(rows_within(milliseconds(50), {.once = 0, .per_row = 0}), 64);
  EXPECT_EQ(rows_within(milliseconds(50), {.once = 0, .per_row = 1e-9}), 64);
}

/// What a night noted of chains.
NightHistory::Chain noted(const ScratchPath& store) {
  return read_history(store.path(), id(kSquare)).chain.value_or(NightHistory::Chain{});
}

TEST(AccessRows, StayAsTheyWereMeasuredForATime) {
  const ScratchPath store("access_rows");
  record(store.path(), kSquare, 0, 20, false);
  auto options = quick_consolidation();
  options.representation.kind = Representation::kVideo;
  options.representation.bound_db = 30;
  options.access = milliseconds(50);
  night(store.path(), options);
  EXPECT_EQ(noted(store), (NightHistory::Chain{milliseconds(50), 64})) << "tiny images";

  // A night that measured something else, as another machine would.
  NightHistory history = read_history(store.path(), id(kSquare));
  history.chain->rows = 24;
  write_history(store.path(), id(kSquare), history);
  record(store.path(), kSquare, 100, 20, false);
  night(store.path(), options);
  EXPECT_EQ(noted(store), (NightHistory::Chain{milliseconds(50), 24}));

  options.access = milliseconds(40);
  record(store.path(), kSquare, 200, 20, false);
  night(store.path(), options);
  EXPECT_EQ(noted(store), (NightHistory::Chain{milliseconds(40), 64})) << "another time";
}

}  // namespace
}  // namespace engram::training
