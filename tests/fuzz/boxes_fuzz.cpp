// SPDX-License-Identifier: Apache-2.0
// What a program answers of an image.
#include <cmath>

#include "ltm/redaction/box.h"
#include "tests/fuzz/fuzz_check.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto boxes = engram::ltm::parse_boxes(engram::fuzzed_text(data, size), 7);
  if (!boxes.ok()) return 0;
  ENGRAM_CHECK(boxes->size() <= engram::ltm::kMaxBoxes, "{} boxes", boxes->size());
  for (const engram::ltm::Box& box : *boxes)
    ENGRAM_CHECK(std::isfinite(box.x) && std::isfinite(box.y) && box.width > 0 && box.height > 0,
                 "a box of {} x {}", box.width, box.height);
  return 0;
}
