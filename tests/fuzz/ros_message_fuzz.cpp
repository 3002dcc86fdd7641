// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "datasets/ros/message_type.h"
#include "ltm/core/buffer.h"
#include "tests/fuzz/fuzz_check.h"

/// What decodes is written, and read as the same again. The first byte chooses the serialization
/// and the type's name; the definition goes to the first zero, the message follows.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::datasets::ros;
  if (size < 1) return 0;
  constexpr std::array<std::string_view, 4> kNames{
      "sensor_msgs/Image", "sensor_msgs/CompressedImage", "sensor_msgs/msg/JointState", "a/B"};
  const auto text = fuzzed_text(data + 1, size - 1);
  const size_t end = text.find('\0');
  if (end == std::string_view::npos) return 0;
  const auto type =
      MessageType::create(kNames[data[0] / 2 % kNames.size()], text.substr(0, end),
                          data[0] % 2 == 0 ? Serialization::kRos1 : Serialization::kCdr);
  if (!type.ok()) return 0;
  const auto value = type->decode(as_bytes(text.substr(end + 1)));
  if (!value.ok()) return 0;
  static_cast<void>(header_stamp(*value));
  static_cast<void>(type->segment(&*value));
  const auto bytes = type->encode(*value);
  ENGRAM_CHECK(bytes.ok(), "{}", bytes.status().message());
  const auto again = type->decode(*bytes);
  ENGRAM_CHECK(again.ok(), "{}", again.status().message());
  ENGRAM_CHECK(*again == *value, "reads as something else");
  return 0;
}
