// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment writer and reader.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/store/segment_source.h"

namespace engram::ltm {

/// Where the rows of an entity lie in a segment file.
struct EntityPlace {
  std::string group;
  uint64_t first = 0;  ///< Row in the group.
  uint64_t rows = 0;
};

/// The path of shared group `number`.
[[nodiscard]] std::string shared_group(size_t number);

/// The share of `rows` of `all_rows` in `bytes`.
[[nodiscard]] uint64_t share_of(uint64_t bytes, uint64_t rows, uint64_t all_rows);

/// One entity of a shared group.
struct SharedEntity {
  MemoryId id;
  int32_t group = 0;
  uint64_t first = 0;
  uint64_t rows = 0;
};

/// Writes the directory of entities that share groups. `entities` are in the order of their IDs.
/// Errors: those of h5::File::write.
Status write_shared_directory(h5::File& file, const std::vector<SharedEntity>& entities);

/// Reads it, a block of names at a time, so that finding one entity of a million costs little.
///
/// Errors: kDataLoss. Where names are damaged, the others are still found.
/// Threading: one thread. The source must outlive it.
/// Source: docs/format.md, "Shared groups".
class SharedDirectory {
 public:
  explicit SharedDirectory(SegmentSource& source) : source_(source) {}

  /// The place of an entity; nothing if it shares no group.
  Result<std::optional<EntityPlace>> find(const MemoryId& entity);

  /// Visits all entities whose names can be read; returns an error for each block that cannot.
  Result<std::vector<Status>> for_each(const std::function<void(const MemoryId&)>& visit);

 private:
  struct Block {
    uint64_t number = 0;
    uint64_t last_use = 0;
    std::vector<MemoryId> names;
  };
  struct Begin {
    MemoryId name;  ///< The first one of the block.
    uint64_t block = 0;
  };

  Status load();
  Status load_begins(uint64_t blocks);
  /// Reads all names, because the list of their beginnings is damaged.
  void find_begins(uint64_t blocks);
  Result<const Block*> block(uint64_t number);
  Result<std::vector<MemoryId>> read_names(uint64_t number);
  Result<EntityPlace> place(uint64_t index);

  SegmentSource& source_;
  std::optional<bool> is_there_;
  uint64_t per_block_ = 1;
  uint64_t blocks_ = 0;
  std::vector<Begin> begins_;
  std::vector<Block> kept_;
  uint64_t uses_ = 0;
};

}  // namespace engram::ltm
