// SPDX-License-Identifier: Apache-2.0
#include "server/robot/host_state.h"

#include "ltm/idf/type_check.h"
#include "ltm/memory/segment_types.h"
#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

HostState full_state() {
  HostState state;
  state.cpu_share = 0.25;
  state.ram = {1000, 400};
  state.group_ram = RamState{500, 100};
  state.cpu_pressure = Pressure{1.5, std::nullopt};
  state.memory_pressure = Pressure{12.5, 3.0};
  state.io_pressure = Pressure{0, 0};
  state.disks = {{"/", 100, 50}, {"/unplugged", std::nullopt, std::nullopt}};
  state.process_bytes = 77;
  return state;
}

TEST(HostState, IsAValueOfItsType) {
  EXPECT_OK(idf::to_status(idf::check(to_data(full_state()), host_state_type())));
  EXPECT_OK(idf::to_status(
      idf::check(to_data(full_state(), RamLimit{5, "as configured"}), host_state_type())));
  EXPECT_OK(idf::to_status(idf::check(to_data(HostState()), host_state_type())));
}

TEST(HostState, StaysInItsTypeWhateverWasRead) {
  HostState state = full_state();
  state.cpu_share = 1.5;
  state.memory_pressure->some = 101;
  state.ram.total_bytes = UINT64_MAX;
  EXPECT_OK(idf::to_status(idf::check(to_data(state), host_state_type())));
}

TEST(HostState, SaysWhatWasRead) {
  const idf::Data data = to_data(full_state(), RamLimit{5, "why"});
  EXPECT_EQ(*data.at("cpu_share"), idf::Data(0.25f));
  EXPECT_EQ(*data.at("group_ram/available"), idf::Data(int64_t{100}));
  EXPECT_EQ(*data.at("memory_pressure/full"), idf::Data(3.0f));
  EXPECT_EQ(*data.at("disks/0/free"), idf::Data(int64_t{50}));
  EXPECT_TRUE(data.at("disks/1/free")->is<idf::None>());
  EXPECT_TRUE(data.at("cpu_pressure/full")->is<idf::None>());
  EXPECT_EQ(*data.at("working_memory_limit"), idf::Data(int64_t{5}));
  EXPECT_EQ(*data.at("working_memory_reason"), idf::Data("why"));
}

TEST(HostState, KnowsWhereTheLeastRamIsLeft) {
  HostState state;
  state.ram = {1000, 400};
  EXPECT_EQ(state.tightest_ram(), state.ram);
  state.group_ram = RamState{500, 100};
  EXPECT_EQ(state.tightest_ram(), *state.group_ram);
  state.group_ram = RamState{500, 450};
  EXPECT_EQ(state.tightest_ram(), state.ram);
}

TEST(HostState, BelongsToAnEntityOfTheHost) {
  const auto entity = host_state_entity("arm/left");
  ASSERT_OK(entity);
  EXPECT_EQ(entity->to_string(), "SystemState/Host/arm\\/left/load");
  EXPECT_FALSE(host_state_entity("").ok());
  ltm::SegmentTypes types;
  EXPECT_OK(types.declare(*ltm::MemoryId::parse("SystemState/Host"), host_state_type()));
}

}  // namespace
}  // namespace engram::server
