// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "ltm/core/file.h"
#include "ltm/idf/type.h"
#include "ltm/store/publish.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

/// A store with every kind of file and of content, and what was put into it.
///
/// Two recorded segments ("cam" with PNG media, links and a type; "arm" with Zstandard media and a
/// provider of its own), a latent segment with its model, and a journal with more of both entities.
struct FullStore {
  static constexpr int64_t kSealed = 40;
  static constexpr int64_t kLatent = 30;
  static constexpr int64_t kUnsealed = 10;

  std::filesystem::path path;
  std::map<MemoryId, std::map<Time, Snapshot>> snapshots;
  bool has_blocks = false;  ///< Latents are coded as blocks.

  static MemoryId arm() { return *MemoryId::from_names({"Body", "Arm", "left", "arm"}); }

  static Snapshot snapshot(const MemoryId& entity, int64_t index) {
    const auto x = static_cast<double>(index);
    idf::Dict value{{"image", example_image(12, 10, 3, index)},
                    {"x", 0.5 * x},
                    {"n", static_cast<int32_t>(index)},
                    {"closed", index % 2 == 0},
                    {"force", idf::NdArray::take<float>({3}, {1, 2, static_cast<float>(index)})},
                    {"label", "number " + std::to_string(index)},
                    {"hand", index % 4 == 0 ? "Body/Hand/left/palm" : arm().to_string()}};
    Snapshot made{entity, example_time(index), {{value, example_metadata(index)}}};
    // Snapshots of "arm" have one or two instances.
    if (entity == arm() && index % 3 == 0) made.instances.push_back(made.instances.front());
    return made;
  }

  static idf::Type cam_type() {
    using idf::Type;
    return Type::object("View", {{"image", Type::image(idf::PixelType::kRgb24)},
                                 {"x", Type::float64({"m"})},
                                 {"n", Type::int32()},
                                 {"closed", Type::boolean()},
                                 {"force", Type::ndarray(idf::ElementType::kFloat32, {3}, {"N"})},
                                 {"label", Type::string()},
                                 {"hand", Type::memory_link()}});
  }

  static PackedSnapshot packed(const Snapshot& snapshot) {
    const PackOptions options{.image_codec = snapshot.entity == arm() ? "zstd" : "png"};
    PackedSnapshot made{snapshot.entity, snapshot.time, {}, snapshot.raw_bytes(), 1, 100};
    for (const Instance& instance : snapshot.instances)
      made.instances.push_back({*pack(instance.data, options), instance.metadata});
    return made;
  }

  void append(StoreWriter& writer, const MemoryId& entity, int64_t first, int64_t end) {
    for (int64_t i = first; i < end; ++i) {
      const Snapshot made = snapshot(entity, i);
      ASSERT_OK(writer.append({packed(made)}, nullptr));
      snapshots[entity][made.time] = made;
    }
  }

  /// Makes the store at `place`; the last writer is gone without sealing.
  static FullStore make(const std::filesystem::path& place, bool has_blocks = false) {
    FullStore store;
    store.path = place;
    store.has_blocks = has_blocks;
    EXPECT_OK(create_store(place));
    const auto writer = *StoreWriter::open(place, {});
    EXPECT_OK(writer->declare(example_entity().parent(), cam_type()));
    for (const MemoryId& entity : {example_entity(), arm()}) {
      store.append(*writer, entity, 0, kSealed);
      EXPECT_OK(writer->append_dropped(entity, 2, 200));
      EXPECT_OK(writer->seal());
    }
    const auto model = *temporary_file(place, ".model");
    EXPECT_OK(replace_file(model, as_bytes("weights of a model that sees")));
    EXPECT_OK(publish_model(
        place, example_entity(), 1, model,
        has_blocks ? example_block_latents(0, kLatent, 1) : example_latents(0, kLatent, 1)));
    for (const MemoryId& entity : {example_entity(), arm()})
      store.append(*writer, entity, kSealed, kSealed + kUnsealed);
    return store;
  }
};

/// What a store gives back, each value compared with what was put in.
struct ReadBack {
  uint64_t recorded = 0;
  uint64_t latent = 0;
  uint64_t wrong = 0;
  uint64_t failed = 0;  ///< Reads that told an error.
};

inline bool is_example_latent(const LatentSnapshot& found, Time time, bool has_blocks) {
  const int64_t index = (to_ns(time) - kExampleStart_ns) / 200'000'000;
  const LatentSnapshot expected =
      has_blocks ? example_block_latent(index, 1) : example_latent(index, 1);
  return found.time == time && found.model_version == 1 && found.instances.size() == 1 &&
         is_equal(found.instances[0].latent, expected.instances[0].latent) &&
         found.instances[0].metadata == expected.instances[0].metadata &&
         found.instances[0].quality == expected.instances[0].quality;
}

/// Reads all of a store through StoreReader.
inline ReadBack read_back(const FullStore& expected, const std::filesystem::path& place) {
  ReadBack result;
  const auto reader = StoreReader::open(place);
  if (!reader.ok()) return ++result.failed, result;
  for (const MemoryId& entity : (*reader)->entities()) {
    const auto known = expected.snapshots.find(entity);
    const auto entries = (*reader)->index(entity);
    if (known == expected.snapshots.end()) ++result.wrong;
    if (!entries.ok()) ++result.failed;
    if (!entries.ok() || known == expected.snapshots.end()) continue;
    for (const SnapshotEntry& entry : **entries) {
      if (entry.recorded) {
        const auto found = (*reader)->read_recorded(entity, entry);
        const auto original = known->second.find(entry.time);
        if (!found.ok())
          ++result.failed;
        else
          ++(original != known->second.end() && *found == original->second ? result.recorded
                                                                           : result.wrong);
      }
      if (!entry.latent) continue;
      const auto found = (*reader)->read_latent(entity, entry);
      if (!found.ok())
        ++result.failed;
      else
        ++(is_example_latent(*found, entry.time, expected.has_blocks) ? result.latent
                                                                      : result.wrong);
    }
  }
  return result;
}

inline constexpr uint64_t kFullRecorded = 2 * (FullStore::kSealed + FullStore::kUnsealed);
inline constexpr uint64_t kFullLatent = FullStore::kLatent;

/// Flips one bit of a file.
inline void flip_bit(const std::filesystem::path& file, uint64_t bit) {
  const Buffer whole = *read_file(file);
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  damaged[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
  overwrite_file(file, damaged);
}

}  // namespace engram::ltm
