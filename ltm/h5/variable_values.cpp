// SPDX-License-Identifier: Apache-2.0
#include "ltm/h5/variable_values.h"

#include <optional>

namespace engram::h5 {

namespace {

constexpr uint64_t kMaxVariableBytes = 1 << 28;
constexpr size_t kHeapHeaderBytes = 16;

/// One collection of values. It is kept, because the next values are usually in it too.
struct Collection {
  uint64_t offset = 0;
  RawBytes bytes;
};

Result<Collection> read_collection(const RawFile& file, uint64_t offset) {
  ENGRAM_ASSIGN_OR_RETURN(const RawBytes start, file.read(offset, kHeapHeaderBytes));
  if (std::memcmp(start.data(), "GCOL", 4) != 0)
    return data_loss("offset {}: no global heap", offset);
  Collection collection{offset, {}};
  ENGRAM_ASSIGN_OR_RETURN(collection.bytes, file.read(offset, raw_number<uint64_t>(start, 8)));
  return collection;
}

Result<std::string> value_in(const Collection& collection, uint32_t index, uint64_t size) {
  const RawView heap = collection.bytes;
  for (uint64_t at = kHeapHeaderBytes; at + kHeapHeaderBytes <= heap.size();) {
    const auto found = raw_number<uint16_t>(heap, at);
    const auto bytes = raw_number<uint64_t>(heap, at + 8);
    at += kHeapHeaderBytes;
    if (found == 0 || bytes > heap.size() - at) break;
    if (found == index && size <= bytes)
      return std::string(reinterpret_cast<const char*>(heap.data()) + at, size);
    at += padded_size(bytes);
  }
  return data_loss("offset {}: the global heap has no object {} of {} bytes", collection.offset,
                   index, size);
}

}  // namespace

Result<std::vector<std::string>> variable_values(const RawFile& file, RawView references,
                                                 uint64_t count) {
  if (references.size() / kReferenceBytes < count)
    return data_loss("{} bytes of references, {} values need {} each", references.size(), count,
                     kReferenceBytes);
  std::vector<std::string> values;
  std::optional<Collection> collection;
  uint64_t total = 0;
  for (uint64_t i = 0; i < count; ++i) {
    const RawView one = references.subspan(i * kReferenceBytes, kReferenceBytes);
    const auto size = raw_number<uint32_t>(one, 0);
    const auto offset = raw_number<uint64_t>(one, 4);
    total += size;
    if (total > kMaxVariableBytes)
      return data_loss("values of more than {} bytes", kMaxVariableBytes);
    if (size == 0 || offset == 0) {
      values.emplace_back();
      continue;
    }
    if (!collection || collection->offset != offset) {
      ENGRAM_ASSIGN_OR_RETURN(collection, read_collection(file, offset));
    }
    ENGRAM_ASSIGN_OR_RETURN(std::string value,
                            value_in(*collection, raw_number<uint32_t>(one, 12), size));
    values.push_back(std::move(value));
  }
  return values;
}

}  // namespace engram::h5
