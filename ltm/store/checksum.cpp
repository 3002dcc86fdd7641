// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/checksum.h"

#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "ltm/core/file.h"

namespace engram::ltm {

uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

Result<uint64_t> checksum_of_file(const std::filesystem::path& path) {
  constexpr uint64_t kPiece = 1 << 20;
  ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(path, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                       XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<std::byte> piece(std::min(size, kPiece));
  for (uint64_t at = 0; at < size; at += piece.size()) {
    piece.resize(std::min(kPiece, size - at));
    ENGRAM_RETURN_IF_ERROR(file.read_at(at, piece));
    XXH3_64bits_update(state.get(), piece.data(), piece.size());
  }
  return XXH3_64bits_digest(state.get());
}

}  // namespace engram::ltm
