// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "ltm/codec/packed_value.h"
#include "ltm/memory/snapshot.h"
#include "ltm/store/latent.h"
#include "ltm/store/packed_snapshot.h"
#include "ltm/store/store_reader.h"
#include "tests/ltm/print_values.h"

namespace engram::ltm {

inline constexpr int64_t kExampleStart_ns = 1'600'000'000'000'000'000;

/// The time of example snapshot `index`: five a second.
inline Time example_time(int64_t index) {
  return time_from_ns(kExampleStart_ns + index * 200'000'000);
}

inline MemoryId example_entity(const std::string& name = "cam") {
  return *MemoryId::from_names({"Vision", "RGB", "head", name});
}

inline InstanceMetadata example_metadata(int64_t index) {
  const Time time = example_time(index);
  return {time, time + Duration(1), time + Duration(2), "camera driver", 0.5f};
}

/// A small image with a pattern that depends on `seed`.
inline idf::NdArray example_image(int64_t height, int64_t width, int64_t channels, int64_t seed) {
  std::vector<uint8_t> pixels(static_cast<size_t>(height * width * channels));
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<uint8_t>(i * 7 + static_cast<size_t>(seed) * 13 + i / 31);
  return idf::NdArray::take({height, width, channels}, std::move(pixels));
}

/// A number, a text and a counter: no media.
inline Snapshot example_snapshot(const MemoryId& entity, int64_t index) {
  idf::Dict value{{"x", 0.25 * static_cast<double>(index)},
                  {"count", static_cast<int32_t>(index)},
                  {"label", "number " + std::to_string(index)}};
  return {entity, example_time(index), {{std::move(value), example_metadata(index)}}};
}

inline PackedSnapshot pack_snapshot(const Snapshot& snapshot) {
  PackedSnapshot packed{snapshot.entity, snapshot.time, {}, snapshot.raw_bytes(), 0, 0};
  for (const Instance& instance : snapshot.instances)
    packed.instances.push_back({*pack(instance.data, {}), instance.metadata});
  return packed;
}

inline PackedSnapshot packed_example(int64_t index, const MemoryId& entity = example_entity()) {
  return pack_snapshot(example_snapshot(entity, index));
}

/// Every recorded snapshot of the entity, decoded.
inline Result<std::vector<Snapshot>> read_all(StoreReader& reader, const MemoryId& entity) {
  std::vector<Snapshot> snapshots;
  ENGRAM_ASSIGN_OR_RETURN(const auto* entries, reader.index(entity));
  for (const SnapshotEntry& entry : *entries) {
    if (!entry.recorded) continue;
    ENGRAM_ASSIGN_OR_RETURN(Snapshot snapshot, reader.read_recorded(entity, entry));
    snapshots.push_back(std::move(snapshot));
  }
  return snapshots;
}

/// A made-up latent of example snapshot `index`.
inline LatentSnapshot example_latent(int64_t index, int version) {
  std::vector<uint8_t> code(5 + static_cast<size_t>(index % 3), static_cast<uint8_t>(index));
  code.push_back(static_cast<uint8_t>(version));
  LatentInstance instance{
      {Buffer::take(std::move(code)), {idf::Data("rest")}}, example_metadata(index), {4.0, 0.5}};
  return {example_time(index), version, {std::move(instance)}};
}

inline std::vector<LatentSnapshot> example_latents(int64_t first, int64_t end, int version) {
  std::vector<LatentSnapshot> latents;
  for (int64_t i = first; i < end; ++i) latents.push_back(example_latent(i, version));
  return latents;
}

/// Rows and bytes of the blocks that the latents below are of.
inline constexpr int64_t kExampleBlockRows = 6;
inline constexpr size_t kExampleBlockBytes = 500;

/// A made-up latent of example snapshot `index`, in a block with its neighbours: the bytes of each
/// are equal, not shared. Every other block has faded.
inline LatentSnapshot example_block_latent(int64_t index, int version) {
  const int64_t block = index / kExampleBlockRows;
  std::vector<uint8_t> code(kExampleBlockBytes, static_cast<uint8_t>(version));
  for (size_t i = 0; i < code.size(); ++i) code[i] += static_cast<uint8_t>(i * (block + 3) + i / 7);
  LatentSnapshot made = example_latent(index, version);
  made.instances[0].latent.code = Buffer::take(std::move(code));
  if (block % 2 == 1) made.instances[0].quality = {{4.0, 0.5}, {{9.0, 0.75}}, 32};
  made.instances[0].latent.place = {static_cast<uint32_t>(index % kExampleBlockRows),
                                    static_cast<uint32_t>(kExampleBlockRows)};
  return made;
}

inline std::vector<LatentSnapshot> example_block_latents(int64_t first, int64_t end, int version) {
  std::vector<LatentSnapshot> latents;
  for (int64_t i = first; i < end; ++i) latents.push_back(example_block_latent(i, version));
  return latents;
}

/// Code, remainder and place.
inline bool is_equal(const Latent& a, const Latent& b) {
  return std::ranges::equal(a.code.bytes(), b.code.bytes()) && a.remainder == b.remainder &&
         a.place.index == b.place.index && a.place.count == b.place.count;
}

}  // namespace engram::ltm
