// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/snapshot.h"

#include <cmath>

#include "ltm/idf/binary.h"
#include "ltm/idf/json.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/memory/random_memory.h"

namespace engram::ltm {
namespace {

TEST(Snapshot, CountsTheBytesOfItsPlainValues) {
  const MemoryId entity = *MemoryId::parse("a/b/c/d");
  const idf::Data value = idf::Dict{
      {"image", idf::NdArray::take<uint8_t>({10, 10, 3}, std::vector<uint8_t>(300))}, {"x", 1.0}};
  Snapshot snapshot{entity, time_from_ns(5), {{value, {}}}};
  EXPECT_EQ(snapshot.raw_bytes(), idf::encode(value)->size());
  EXPECT_GT(snapshot.raw_bytes(), 300u);
  snapshot.instances.push_back({idf::Data(true), {}});
  EXPECT_EQ(snapshot.raw_bytes(), idf::encode(value)->size() + 5);
  EXPECT_EQ(Snapshot{}.raw_bytes(), 0u);
  EXPECT_EQ(snapshot.id(), entity.at(time_from_ns(5)));
}

TEST(Snapshot, ReadsBackItsDataInBothForms) {
  const Snapshot snapshot = random_snapshot(5);
  const auto bytes = idf::encode(snapshot.to_data());
  ASSERT_OK(bytes);
  EXPECT_EQ(*Snapshot::from_data(*idf::decode(Buffer::copy(*bytes))), snapshot);
  const auto json = idf::to_json_text(snapshot.to_data());
  ASSERT_OK(json);
  EXPECT_EQ(*Snapshot::from_data(*idf::from_json_text(*json)), snapshot);
}

TEST(Snapshot, IsAugmentedWhereAnyInstanceIs) {
  Snapshot snapshot = random_snapshot(7);
  EXPECT_FALSE(snapshot.is_augmented());
  snapshot.instances.push_back({idf::Data(1), {}});
  snapshot.instances.back().metadata.origin = *MemoryId::parse("a/b/c/d/2022-02-18 13:06:56/0");
  EXPECT_TRUE(snapshot.is_augmented());
  snapshot.instances.back().metadata.recipe = R"({"version":1,"changes":[]})";
  EXPECT_EQ(*Snapshot::from_data(snapshot.to_data()), snapshot);
  snapshot.instances.back().metadata.origin = {};
  EXPECT_TRUE(snapshot.is_augmented());
  idf::Data data = snapshot.to_data();
  data.at("instances")
      ->get_if<idf::List>()
      ->back()
      .at("metadata")
      ->get_if<idf::Dict>()
      ->set("origin", "a//b");
  EXPECT_FAILS(Snapshot::from_data(data), StatusCode::kInvalidArgument, "metadata: origin");
}

TEST(Snapshot, RefusesDataThatIsNone) {
  const idf::Data good = random_snapshot(6).to_data();
  const auto changed = [&good](std::string_view path, idf::Data value) {
    idf::Data data = good;
    *data.at(path) = std::move(value);
    return Snapshot::from_data(data);
  };
  EXPECT_FAILS(Snapshot::from_data(7), StatusCode::kInvalidArgument, "snapshot: found int32");
  EXPECT_FAILS(Snapshot::from_data(idf::Dict{}), StatusCode::kInvalidArgument,
               "no member 'entity'");
  EXPECT_FAILS(changed("entity", "a/b"), StatusCode::kInvalidArgument, "'a/b' is no entity");
  EXPECT_FAILS(changed("time", "now"), StatusCode::kInvalidArgument,
               "member 'time' is string, needs an integer");
  EXPECT_FAILS(changed("instances", 1), StatusCode::kInvalidArgument, "needs a list");
  EXPECT_FAILS(changed("instances/0", 1), StatusCode::kInvalidArgument, "instance: found int32");
  EXPECT_FAILS(changed("instances/0/metadata/confidence", 1.5), StatusCode::kInvalidArgument,
               "confidence is 1.5");
  EXPECT_FAILS(changed("instances/0/metadata/confidence", std::nan("")),
               StatusCode::kInvalidArgument, "confidence is nan");
  EXPECT_OK(changed("instances/0/metadata/confidence", 1));
}

}  // namespace
}  // namespace engram::ltm
