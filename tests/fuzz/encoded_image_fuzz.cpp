// SPDX-License-Identifier: Apache-2.0
// Bytes that may be an image or video, alone and in a message.
#include "ltm/redaction/encoded_image.h"
#include "tests/fuzz/fuzz_check.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes = std::as_bytes(std::span(data, size));
  const bool is_image = engram::ltm::begins_as_image_or_video(bytes);
  ENGRAM_CHECK(!is_image || size >= 16, "{} bytes were taken for an image", size);
  engram::idf::Dict message;
  const auto number = static_cast<int64_t>(size > 0 ? data[0] : 0);
  message.set("width", number);
  message.set("height", number);
  message.set("format", std::string(engram::fuzzed_text(data, size)));
  message.set("data", engram::idf::NdArray::take({static_cast<int64_t>(size)},
                                                 std::vector<uint8_t>(data, data + size)));
  const auto member = engram::ltm::image_bytes_of(message);
  ENGRAM_CHECK(!member || *member == "data", "found '{}'", *member);
  ENGRAM_CHECK(!member || size >= 16, "{} bytes were taken for an image", size);
  return 0;
}
