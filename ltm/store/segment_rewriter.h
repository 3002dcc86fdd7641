// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: segments that are written anew.

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "ltm/store/rewrite.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/temporary_file.h"

namespace engram::ltm {

/// What becomes of a recorded snapshot when its segment is written anew.
enum class Fate {
  kKeep,
  kDrop,    ///< Its latents stay: reports go on counting it.
  kForget,  ///< It goes altogether.
};
using FateOf = std::function<Fate(const MemoryId&, const SnapshotEntry&)>;

/// Adds what was forgotten to what the manifest counts.
void add_sums(Manifest& manifest, const std::map<MemoryId, ForgottenSums>& gone);

/// A segment that is written and not published yet.
struct MadeSegment {
  TemporaryFile file;
  SegmentInfo info;  ///< Without `file`.
};

/// Puts `made` in the place of segments that are there now; the files of these go. Nothing in
/// `made`: they go alone. `note` may change the manifest further.
/// Errors: kFailedPrecondition where one of them is not there any more; those of edit_manifest.
Status replace_segments(const std::filesystem::path& store, const std::vector<SegmentInfo>& old,
                        const std::optional<MadeSegment>& made,
                        const std::function<void(Manifest&)>& note);

/// Writes recorded segments anew as one: without what updates replaced and what is to go, all else
/// stored as it was.
///
/// Threading: one thread. The reader must outlive it.
class SegmentRewriter {
 public:
  SegmentRewriter(std::filesystem::path store, StoreReader& reader, FateOf fate_of)
      : store_(std::move(store)), reader_(reader), fate_of_(std::move(fate_of)) {}

  /// `numbers` ascend: indices into the reader's manifest's segments. One alone of which nothing
  /// goes stays as it is. Adds to the report.
  /// Errors: kDataLoss; those of replace_segments.
  Status rewrite(const std::vector<uint32_t>& numbers, RewriteReport& report);

 private:
  std::filesystem::path store_;
  StoreReader& reader_;
  FateOf fate_of_;
};

}  // namespace engram::ltm
