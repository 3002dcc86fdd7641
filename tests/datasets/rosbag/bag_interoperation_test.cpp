// SPDX-License-Identifier: Apache-2.0
// Bags of ours, read by Python's rosbag.
#include <sys/wait.h>

#include <cstdlib>

#include "datasets/rosbag/bag_writer.h"
#include "datasets/rosbag/connection_coder.h"
#include "tests/datasets/recordings/format_stores.h"
#include "tests/datasets/rosbag/example_bags.h"

namespace engram::datasets::rosbag {
namespace {

using idf::Dict;
using idf::List;
using idf::NdArray;

constexpr int kNoRosbag = 77;

/// Exit code of a script of this folder.
int run_script(const std::string& arguments) {
  const auto folder = std::filesystem::path(ENGRAM_SOURCE_DIR) / "tests/datasets/rosbag";
  const int status =
      std::system(fmt::format("/usr/bin/python3 '{}'/{}", folder.string(), arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

template <typename T>
NdArray pixels(int64_t channels, int64_t first) {
  std::vector<T> values;
  for (int64_t i = 0; i < 16 * 24 * channels; ++i) values.push_back(static_cast<T>(first + i));
  return NdArray::take({16, 24, channels}, std::move(values));
}

NdArray doubles(std::vector<double> values) {
  const auto size = static_cast<int64_t>(values.size());
  return NdArray::take({size}, std::move(values));
}

std::map<std::string, idf::Data> values_at(int64_t index) {
  const auto number = static_cast<double>(index);
  return {{"Vision/RGB/head/cam", Dict{{"image", pixels<uint8_t>(3, index)}}},
          {"Vision/Depth/head/cam", Dict{{"depth", pixels<uint16_t>(1, index * 1000)}}},
          {"RobotState/Proprioception/arm/joints", Dict{{"name", List{"left", "right"}},
                                                        {"position", doubles({0.5, number})},
                                                        {"velocity", doubles({})},
                                                        {"effort", doubles({})}}},
          {"Speech/Heard/head/said", Dict{{"text", fmt::format("number {}", index)}}},
          {"A/B/c/reward", Dict{{"reward", number / 2}}}};
}

void write_example(BagWriter& writer) {
  std::map<std::string, Connection> connections;
  const auto add = [&](const std::string& name, const idf::Data& value) {
    const auto id = static_cast<uint32_t>(connections.size());
    connections[name] =
        own_connection(id, "/" + name, ltm::MemoryId::parse(name).value(), value, false);
    writer.add(connections[name]);
  };
  for (const auto& [name, value] : values_at(0)) add(name, value);
  add("A/B/c/silent", "text");
  for (int64_t index = 0; index < 50; ++index)
    for (const auto& [name, value] : values_at(index)) {
      const Connection& connection = connections.at(name);
      const int64_t time = 1'700'000'000'000'000'000 + index * 100'000'000;
      const auto bytes =
          ConnectionCoder::create(connection).encode(value, time_from_ns(time - 1'000'000'000), 0);
      ASSERT_OK(bytes);
      ASSERT_OK(writer.write({connection.id, static_cast<uint64_t>(time), *bytes}));
    }
}

TEST(BagInteroperation, PythonsRosbagReadsWhatWeWrite) {
  const ScratchDirectory scratch;
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    const auto path = scratch / (compression + ".bag");
    auto writer = BagWriter::create(path, {.chunk_bytes = 20'000, .compression = compression});
    ASSERT_OK(writer);
    ASSERT_NO_FATAL_FAILURE(write_example(*writer));
    ASSERT_OK(writer->close());
    const int code =
        run_script(fmt::format("check_bags.py example '{}' {}", path.string(), compression));
    if (code == kNoRosbag) GTEST_SKIP() << "needs python3-rosbag";
    EXPECT_EQ(code, 0) << compression;
  }
}

TEST(BagInteroperation, PythonsRosbagReadsABagWithoutMessages) {
  const ScratchDirectory scratch;
  auto writer = BagWriter::create(scratch / "a.bag", {});
  ASSERT_OK(writer);
  const auto entity = ltm::MemoryId::parse("A/B/c/silent").value();
  writer->add(own_connection(0, "/A/B/c/silent", entity, "text", false));
  ASSERT_OK(writer->close());
  const int code =
      run_script(fmt::format("check_bags.py silent '{}'", (scratch / "a.bag").string()));
  if (code == kNoRosbag) GTEST_SKIP() << "needs python3-rosbag";
  EXPECT_EQ(code, 0);
}

TEST(BagInteroperation, PythonsBagsComeBackToPython) {
  const ScratchDirectory scratch;
  const FormatStores bags(make_rosbag_format());
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    const auto path = scratch / (compression + ".bag");
    const auto store = scratch / compression;
    const auto copy = scratch / (compression + "_copy.bag");
    const int made = run_script(fmt::format("write_bag.py '{}' {}", path.string(), compression));
    if (made == kNoRosbag) GTEST_SKIP() << "needs python3-rosbag and its messages";
    ASSERT_EQ(made, 0);
    ASSERT_OK(bags.import(path, store));
    ASSERT_OK(bags.write(store, copy));
    EXPECT_EQ(run_script(fmt::format("check_bags.py same '{}' '{}'", path.string(), copy.string())),
              0)
        << compression;
  }
}

}  // namespace
}  // namespace engram::datasets::rosbag
