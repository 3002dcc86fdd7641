// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/held_bytes.h"

namespace engram::idf {

namespace {

/// What the allocator adds to a block.
constexpr size_t kBlock = 16;

size_t heap_bytes(const std::string& text) {
  // Short ones lie inside of the string.
  return text.capacity() < sizeof(std::string) / 2 ? 0 : text.capacity() + 1 + kBlock;
}

/// Besides the value itself, which lies in its owner.
size_t heap_bytes(const Data& data) {
  if (const auto* text = data.get_if<std::string>()) return heap_bytes(*text);
  if (const auto* array = data.get_if<NdArray>())
    // The shape, and the block that counts who shares the elements.
    return array->shape().size() * sizeof(int64_t) + 3 * kBlock;
  size_t bytes = 0;
  if (const auto* list = data.get_if<List>()) {
    bytes = kBlock + list->capacity() * sizeof(Data);
    for (const Data& each : *list) bytes += heap_bytes(each);
  } else if (const auto* dict = data.get_if<Dict>()) {
    bytes = kBlock;
    for (const DictEntry& entry : *dict)
      bytes += sizeof(DictEntry) + heap_bytes(entry.key) + heap_bytes(entry.value);
  }
  return bytes;
}

}  // namespace

size_t held_bytes(const Data& data) {
  return sizeof(Data) + heap_bytes(data);
}

size_t element_bytes(const Data& data) {
  if (const auto* array = data.get_if<NdArray>()) return array->bytes().size();
  size_t bytes = 0;
  if (const auto* list = data.get_if<List>())
    for (const Data& each : *list) bytes += element_bytes(each);
  if (const auto* dict = data.get_if<Dict>())
    for (const DictEntry& entry : *dict) bytes += element_bytes(entry.value);
  return bytes;
}

}  // namespace engram::idf
