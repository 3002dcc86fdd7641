// SPDX-License-Identifier: Apache-2.0
// What ltm/h5 reads of a file without HDF5: object headers, values of variable length, chunks.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "ltm/h5/chunk_filters.h"
#include "ltm/h5/object_header.h"
#include "ltm/h5/variable_values.h"
#include "tests/fuzz/fuzz_check.h"

namespace {

using namespace engram::h5;

void read_object(const RawFile& file, uint64_t offset) {
  const auto header = read_object_header(file, offset);
  if (!header.ok()) return;
  (void)check_dataset(*header).ok();
  (void)has_outer_attributes(*header);
  for (const HeaderMessage& message : *header)
    if (const auto attribute = header_attribute(message))
      (void)variable_values(file, attribute->value, attribute->value.size() / kReferenceBytes).ok();
}

void read_chunk(RawView bytes) {
  using enum ChunkFilter;
  for (const auto& filters : {std::vector<ChunkFilter>{},
                              {kDeflate},
                              {kShuffle, kFletcher32},
                              {kShuffle, kDeflate, kFletcher32}}) {
    const auto chunk =
        unfiltered_chunk({bytes.begin(), bytes.end()}, filters, 0, bytes.size() * 2 + 1, 3);
    if (chunk.ok()) ENGRAM_CHECK(chunk->size() == bytes.size() * 2 + 1, "another size");
  }
}

}  // namespace

/// Whatever a file has in those places: refused, or read within the file.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const RawView bytes(reinterpret_cast<const std::byte*>(data), size);
  static const int memory = ::memfd_create("hdf5_objects_fuzz", 0);
  if (::ftruncate(memory, 0) != 0 || ::pwrite(memory, data, size, 0) != static_cast<ssize_t>(size))
    return 0;
  const auto file = RawFile::open("/proc/self/fd/" + std::to_string(memory), 0);
  if (!file.ok()) return 0;
  read_object(*file, 0);
  (void)variable_values(*file, bytes.first(std::min<size_t>(size, 64)), 4).ok();
  read_chunk(bytes);
  return 0;
}
