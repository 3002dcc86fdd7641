// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/zstd.h"
#include "ltm/likeness/likeness_space.h"
#include "ltm/likeness/stored_codes.h"
#include "ltm/saliency/stored_saliency.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::ltm {
namespace {

/// What is unpacked is packed and unpacked to the same again, or is damaged.
void unpack_both(std::span<const std::byte> bytes) {
  if (const auto codes = unpack_codes(bytes); codes.ok()) {
    const auto again = unpack_codes(pack_codes(*codes));
    ENGRAM_CHECK(again.ok() && again->size() == codes->size(), "codes differ");
    for (size_t i = 0; i < codes->size(); ++i)
      ENGRAM_CHECK((*again)[i].times == (*codes)[i].times && (*again)[i].codes == (*codes)[i].codes,
                   "codes differ");
  } else {
    ENGRAM_CHECK(codes.status().code() == StatusCode::kDataLoss, "{}", codes.status().to_string());
  }
  if (const auto space = LikenessSpace::unpack(bytes); space.ok()) {
    const std::vector<float> descriptor(kDescriptorSize, 0.04f);
    ENGRAM_CHECK(space->code(descriptor).size() == kCodeSize, "a code has another size");
  } else {
    ENGRAM_CHECK(space.status().code() == StatusCode::kDataLoss, "{}", space.status().to_string());
  }
  if (const auto saliency = unpack_saliency(bytes); saliency.ok()) {
    const auto again = unpack_saliency(pack_saliency(*saliency));
    ENGRAM_CHECK(again.ok() && again->size() == saliency->size(), "saliency differs");
    for (size_t i = 0; i < saliency->size(); ++i)
      ENGRAM_CHECK(
          (*again)[i].times == (*saliency)[i].times && (*again)[i].rows == (*saliency)[i].rows,
          "saliency differs");
  } else {
    ENGRAM_CHECK(saliency.status().code() == StatusCode::kDataLoss, "{}",
                 saliency.status().to_string());
  }
  if (const auto weights = unpack_weights(bytes); weights.ok())
    ENGRAM_CHECK(weights->validate().ok(), "weights are wrong");
}

}  // namespace
}  // namespace engram::ltm

/// Packed or, to get further, plain.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  const auto text = fuzzed_text(data, size);
  ltm::unpack_both(as_bytes(text));
  ltm::unpack_both(ltm::compress_zstd(as_bytes(text), 1));
  return 0;
}
