// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ltm/codec/packed_value.h"

namespace engram::ltm {

/// Decodes media one after the other. The groups decoded last are kept: who reads the images of a
/// group in a row, in any order, decodes it once.
///
/// Threading: one thread.
class MediumDecoder {
 public:
  /// About the most decoded bytes that are kept, though always one group.
  static constexpr uint64_t kKeptBytes = uint64_t{256} << 20;

  /// Errors: kDataLoss where the bytes hold anything else; kFailedPrecondition where the decoder of
  /// a group is not installed.
  Result<idf::NdArray> decode(const PackedMedium& medium);

 private:
  struct Group {
    Buffer bytes;  ///< Their place in memory tells one group from another.
    std::vector<idf::NdArray> arrays;
    uint64_t size_bytes = 0;
    uint64_t last_use = 0;
  };

  Result<const Group*> group_of(const PackedMedium& medium);
  void make_room(uint64_t bytes);

  std::vector<Group> groups_;
  uint64_t uses_ = 0;
};

}  // namespace engram::ltm
