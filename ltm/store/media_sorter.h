// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment writer.

#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "ltm/codec/medium_decoder.h"
#include "ltm/codec/seal_rules.h"
#include "ltm/store/segment_media.h"
#include "ltm/store/segment_rows.h"

namespace engram::ltm {

/// Decides which media of an entity are stored as groups of images.
///
/// An encoded group stays one if all its images are present and in order. Otherwise its remaining
/// images are decoded and stored one by one, so that nothing is encoded with loss twice. Images
/// that were recorded without loss become groups if the rules say so.
///
/// Threading: one thread. Rules and rows must outlive it.
class MediaSorter {
 public:
  explicit MediaSorter(const SealRules& rules) : rules_(rules) {}

  /// Adds the media of the next row.
  void append(size_t row, const SegmentRow& media);

  /// Returns the sorted media.
  /// Errors: kDataLoss if a group that must be split up does not decode.
  Result<SortedMedia> finish();

 private:
  struct Place {
    size_t row = 0;
    const PackedMedium* medium = nullptr;
  };
  using Places = std::span<const Place>;
  /// The properties that all images of one group share: path, type, shape and index of the
  /// instance.
  using Stream = std::tuple<std::string, idf::ElementType, idf::Shape, size_t>;
  using Groups = std::vector<GroupColumn>;

  [[nodiscard]] const GroupCodec* codec_for(const PackedMedium& medium) const;
  [[nodiscard]] Places next_group(Places places) const;
  [[nodiscard]] Places next_run(Places places, const GroupCodec& codec) const;

  Status sort(Places places);
  Status sort_group(Places group, Groups& groups);
  void encode(Places run, const GroupCodec& codec, Groups& groups);
  Result<std::vector<std::byte>> encode(Places run, const GroupCodec& codec);
  void keep_single(Places places);

  const SealRules& rules_;
  std::map<Stream, std::vector<Place>> streams_;
  MediumDecoder decoder_;
  std::map<std::string, size_t> encoded_streams_;  ///< Number of encoded streams per path.
  SortedMedia sorted_;
};

}  // namespace engram::ltm
