// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "datasets/formats.h"
#include "datasets/mcap/mcap_writer.h"
#include "datasets/ros/message_type.h"
#include "datasets/ros/standard_definitions.h"
#include "ltm/core/file.h"

namespace engram::datasets {
namespace {

constexpr int kImages = 220;  // Of 640 x 480 in colour: 203 MB.

/// Calls `work` and says how many MB/s it went through.
template <typename F>
void measure(std::string_view what, double bytes, F work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  fmt::print("{:40} {:8.0f} MB/s\n", what, bytes / 1e6 / took.count());
}

void write_images(const std::filesystem::path& path, std::string_view encoding,
                  const std::string& compression, bool has_checksum) {
  const auto definition = std::string(*ros::standard_definition("sensor_msgs/Image"));
  const auto type =
      ros::MessageType::create("sensor_msgs/Image", definition, ros::Serialization::kCdr).value();
  auto writer = mcap::McapWriter::create(
                    path, {.compression = compression, .has_data_checksum = has_checksum})
                    .value();
  writer.add(mcap::SchemaRecord{1, "sensor_msgs/msg/Image", "ros2msg", definition});
  writer.add(mcap::ChannelRecord{1, 1, "/camera", "cdr", {}});
  std::vector<uint8_t> pixels(480 * 640 * 3);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(i * i >> 7);
  const auto bytes = type.encode(idf::Dict{{"image", idf::NdArray::take({480, 640, 3}, pixels)},
                                           {"encoding", encoding}})
                         .value();
  for (uint64_t i = 0; i < kImages; ++i)
    ENGRAM_CHECK(writer.write(mcap::MessageRecord{1, 0, i, i, bytes}).ok(), "not written");
  ENGRAM_CHECK(writer.close().ok(), "not closed");
}

uint64_t read_recording(const std::filesystem::path& path) {
  const auto reader = recognised_format(path).value()->open(path, {}).value();
  uint64_t values = 0;
  while (true) {
    const auto moment = reader->next().value();
    if (!moment) return values;
    values += moment->commit.updates.size();
  }
}

void measure_file(const std::filesystem::path& path, std::string_view what) {
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  fmt::print("{}: {:.1f} MB\n", what, bytes / 1e6);
  measure("  read_file", bytes, [&] { ENGRAM_CHECK(read_file(path).ok(), "not read"); });
  const Buffer all = read_file(path).value();
  measure("  memcpy", bytes, [&] { ENGRAM_CHECK(Buffer::copy(all.bytes()).size() > 0, "empty"); });
  measure("  import's reader (of plain images)", kImages * 640.0 * 480.0 * 3.0, [&] {
    const uint64_t values = read_recording(path);
    ENGRAM_CHECK(values == kImages, "{} values", values);
  });
}

void run(const std::filesystem::path& folder) {
  const auto path = folder / "speed.mcap";
  for (const auto& [encoding, compression, has_checksum] : {std::tuple{"rgb8", "", false},
                                                            {"bgr8", "", false},
                                                            {"rgb8", "", true},
                                                            {"rgb8", "zstd", false},
                                                            {"rgb8", "lz4", false}}) {
    write_images(path, encoding, compression, has_checksum);
    measure_file(path, fmt::format("{}, compression '{}'{}", encoding, compression,
                                   has_checksum ? ", data checksum" : ""));
    std::filesystem::remove(path);
  }
}

}  // namespace
}  // namespace engram::datasets

/// Prints how fast MCAP files of images are read, beside copying their bytes. Usage: FOLDER to
/// write them into, or a FILE of any format that is only read.
int main(int argc, char** argv) {
  using namespace engram::datasets;
  const std::filesystem::path path = argc > 1 ? argv[1] : ".";
  if (std::filesystem::is_directory(path)) return run(path), 0;
  const auto bytes = static_cast<double>(std::filesystem::file_size(path));
  measure("import's reader", bytes, [&] { fmt::print("{} values\n", read_recording(path)); });
  return 0;
}
