// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "encoders/coding/checked_block.h"
#include "encoders/coding/latent_sequence.h"
#include "ltm/core/buffer.h"
#include "tests/fuzz/fuzz_check.h"

namespace engram::encoders {
namespace {

constexpr size_t kRows = 5;

using Grids = std::vector<LatentGrid>;

const std::array<Grids, 3>& grids() {
  static const std::array<Grids, 3> all{Grids{{2, 2, 3}, {1, 4, 6}}, Grids{{3, 1, 1}},
                                        Grids{{1, 3, 2}, {2, 2, 5}, {1, 1, 1}}};
  return all;
}

std::vector<std::byte> sealed(std::span<const std::byte> bytes, uint64_t covered) {
  return with_checksum({bytes.begin(), bytes.end()}, covered);
}

void check_block(const LatentSequenceCodec& codec, std::span<const std::byte> block) {
  const auto latents = codec.decode(block, kRows);
  ENGRAM_CHECK(latents.ok() && latents->size() == kRows * codec.model().latents(), "other latents");
  const auto first = codec.decode(block, kRows, 2);
  ENGRAM_CHECK(first.ok() && std::ranges::equal(*first, std::span(*latents).first(first->size())),
               "the first rows are others alone");
  const auto again = codec.decode(codec.encode(*latents), kRows);
  ENGRAM_CHECK(again.ok() && *again == *latents, "written again they are others");
}

}  // namespace
}  // namespace engram::encoders

/// Whatever a model and a block hold behind fitting checksums, as many latents decode as were asked
/// for and can be written again, and a model is the same after its bytes. The first byte chooses
/// the grids, the next two are the length of the model.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::encoders;
  if (size < 3) return 0;
  const Grids& chosen = grids()[data[0] % grids().size()];
  const auto bytes = as_bytes(fuzzed_text(data + 3, size - 3));
  const size_t length = std::min<size_t>(data[1] + 256u * data[2], bytes.size());
  const uint64_t identity = LatentModel(chosen).identity();
  const auto model = LatentModel::from_bytes(sealed(bytes.first(length), identity), chosen);
  ENGRAM_CHECK(model.ok(), "{}", model.status().to_string());
  const auto again = LatentModel::from_bytes(model->to_bytes(), chosen);
  ENGRAM_CHECK(again.ok() && *again == *model, "lost in its bytes");
  check_block(LatentSequenceCodec(*model), sealed(bytes.subspan(length), kRows));
  return 0;
}
