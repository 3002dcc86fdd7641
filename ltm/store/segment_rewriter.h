// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: rewrites segments.

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "ltm/store/rewrite.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/temporary_file.h"

namespace engram::ltm {

/// What happens to a recorded snapshot when its segment is rewritten.
enum class Fate {
  kKeep,
  kDrop,    ///< Only its recorded form is removed. Its latents stay, and reports still count it.
  kForget,  ///< It is removed in every form.
};
using FateOf = std::function<Fate(const MemoryId&, const SnapshotEntry&)>;

/// Adds forgotten snapshots to the sums in the manifest.
void add_sums(Manifest& manifest, const std::map<MemoryId, ForgottenSums>& gone);

/// A segment that is written but not published yet.
struct MadeSegment {
  TemporaryFile file;
  SegmentInfo info;  ///< Has no `file` yet.
};

/// Replaces the segments `old` by `made` and removes their files. If `made` is empty, they are only
/// removed. `note` may change the manifest further.
/// Errors: kFailedPrecondition if one of `old` is no longer in the manifest; those of
/// edit_manifest.
Status replace_segments(const std::filesystem::path& store, const std::vector<SegmentInfo>& old,
                        const std::optional<MadeSegment>& made,
                        const std::function<void(Manifest&)>& note);

/// Rewrites recorded segments as one segment. It leaves out snapshots that updates replaced and
/// those to be removed; everything else stays stored as it was.
///
/// Threading: one thread. The reader must outlive it.
class SegmentRewriter {
 public:
  SegmentRewriter(std::filesystem::path store, StoreReader& reader, FateOf fate_of)
      : store_(std::move(store)), reader_(reader), fate_of_(std::move(fate_of)) {}

  /// Rewrites the segments `numbers`, ascending indices into the segments of the reader's manifest.
  /// A single segment that loses nothing stays as it is. Adds to the report.
  /// Errors: kDataLoss; those of replace_segments.
  Status rewrite(const std::vector<uint32_t>& numbers, RewriteReport& report);

 private:
  std::filesystem::path store_;
  StoreReader& reader_;
  FateOf fate_of_;
};

}  // namespace engram::ltm
