// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ltm/codec/packed_value.h"

namespace engram::ltm {

/// Decodes media one by one. It keeps the groups decoded last, so reading the images of one group
/// in a row, in any order, decodes the group once.
///
/// Threading: one thread.
class MediumDecoder {
 public:
  /// Approximate max size of the kept decoded groups, in bytes. One group is always kept.
  static constexpr uint64_t kKeptBytes = uint64_t{256} << 20;

  /// Errors: kDataLoss if the bytes contain anything else; kFailedPrecondition if the decoder of a
  /// group is not installed.
  Result<idf::NdArray> decode(const PackedMedium& medium);

 private:
  struct Group {
    Buffer bytes;  ///< Their address in memory identifies the group.
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
