// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/commit.h"

#include "ltm/idf/binary.h"
#include "ltm/idf/json.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/memory/random_memory.h"

namespace engram::ltm {
namespace {

EntityUpdate update(const char* entity, int64_t ns) {
  return {*MemoryId::parse(entity), time_from_ns(ns), {{idf::Data(1.0), {}}}};
}

TEST(Commit, TakesDifferentEntitiesAndTimes) {
  EXPECT_OK(Commit{}.check());
  EXPECT_OK((Commit{{update("a/b/c/d", 5), update("a/b/c/e", 5), update("a/b/c/d", 6)}}.check()));
}

TEST(Commit, RefusesWhatIsIncompleteOrTwice) {
  EXPECT_FAILS((Commit{{update("a/b/c", 5)}}.check()), StatusCode::kInvalidArgument,
               "'a/b/c' is no entity");
  EXPECT_FAILS((Commit{{update("a/b/c/d/0", 5)}}.check()), StatusCode::kInvalidArgument,
               "is no entity");
  Commit empty{{update("a/b/c/d", 5)}};
  empty.updates[0].instances.clear();
  EXPECT_FAILS(empty.check(), StatusCode::kInvalidArgument, "has no instance");
  EXPECT_FAILS((Commit{{update("a/b/c/d", 5), update("a/b/c/e", 5), update("a/b/c/d", 5)}}.check()),
               StatusCode::kInvalidArgument, "'a/b/c/d/1970-01-01 00:00:00.000000005' twice");
}

TEST(Commit, ReadsBackItsDataInBothForms) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    Commit commit;
    for (uint64_t i = 0; i < seed % 4; ++i) commit.updates.push_back(random_snapshot(seed * 4 + i));
    const auto bytes = idf::encode(commit.to_data());
    ASSERT_OK(bytes);
    EXPECT_EQ(*Commit::from_data(*idf::decode(Buffer::copy(*bytes))), commit);
    const auto json = idf::to_json_text(commit.to_data());
    ASSERT_OK(json);
    EXPECT_EQ(*Commit::from_data(*idf::from_json_text(*json)), commit);
  }
}

TEST(Commit, NamesTheUpdateThatCannotBeRead) {
  idf::Data data = Commit{{update("a/b/c/d", 5), update("a/b/c/e", 6)}}.to_data();
  *data.at("updates/1/time") = "late";
  EXPECT_FAILS(Commit::from_data(data), StatusCode::kInvalidArgument,
               "commit: update 1: snapshot: member 'time' is string, needs an integer");
  EXPECT_FAILS(Commit::from_data(idf::Dict{{"updates", 5}}), StatusCode::kInvalidArgument,
               "commit: member 'updates' is int32, needs a list");
  EXPECT_FAILS(Commit::from_data(idf::List{}), StatusCode::kInvalidArgument, "needs a dict");
}

TEST(Commit, ReadsHostileDataWithoutHarm) {
  RandomValues random(41);
  for (int i = 0; i < 3000; ++i) {
    idf::Data data = Commit{{random_snapshot(static_cast<uint64_t>(i))}}.to_data();
    static const char* const kPlaces[] = {"updates",
                                          "updates/0",
                                          "updates/0/entity",
                                          "updates/0/time",
                                          "updates/0/instances",
                                          "updates/0/instances/0",
                                          "updates/0/instances/0/metadata",
                                          "updates/0/instances/0/metadata/provider"};
    *data.at(kPlaces[random.below(8)]) = random.value(2);
    const auto read = Commit::from_data(data);
    if (read.ok()) {
      EXPECT_OK(Commit::from_data(read->to_data()));
    }
  }
}

}  // namespace
}  // namespace engram::ltm
