// SPDX-License-Identifier: Apache-2.0
#include "training/night/access_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "ltm/codec/group_codec.h"
#include "training/night/entity_images.h"

namespace engram::training {

namespace {

/// Snapshots of which a video is made, and how often it is decoded: other work on the machine only
/// adds to the time.
constexpr size_t kRows = 8;
constexpr int kTimes = 3;
/// A usual quality.
constexpr int kCrf = 32;
/// What AV1 took on a machine of two cores, for images of any size.
constexpr double kSecondsPerPixel = 5e-9;

Result<double> seconds_to_decode(const ltm::GroupCodec& codec, std::span<const std::byte> bytes,
                                 std::span<const idf::NdArray> images, size_t wanted) {
  double best = 0;
  for (int i = 0; i < kTimes; ++i) {
    const auto start = std::chrono::steady_clock::now();
    ENGRAM_RETURN_IF_ERROR(codec
                               .decode_first(bytes, images.front().type(), images.front().shape(),
                                             images.size(), wanted)
                               .status());
    const double seconds = to_seconds(std::chrono::steady_clock::now() - start);
    best = i == 0 ? seconds : std::min(best, seconds);
  }
  return best;
}

}  // namespace

int rows_within(Duration access, const DecodingTime& decoding) {
  constexpr std::array kLengths{8, 16, 24, 32, 48, 64};
  constexpr double kShare = 0.75;
  const double left = kShare * to_seconds(access) - decoding.once;
  int rows = kLengths.front();
  for (const int length : kLengths)
    if (length * decoding.per_row <= left) rows = length;
  return rows;
}

Result<DecodingTime> measure_decoding(const EntityWork& work, const PlannedEntity& planned,
                                      const RepresentationOptions& representation, int64_t pixels) {
  const DecodingTime estimated{.once = 0,
                               .per_row = kSecondsPerPixel * static_cast<double>(pixels)};
  MemberImages members;
  const auto& entries = planned.entries;
  for (size_t i = 0; i < std::min(kRows, entries.size()); ++i)
    ENGRAM_RETURN_IF_ERROR(append_images(work, planned.layout, entries[i], members));
  DecodingTime decoding;
  for (const auto& images : members) {
    const VideoSearchOptions search = representation.search(pixels);
    const auto codec =
        ltm::make_group_codec(fmt::format("{}:crf={},{}", search.codec, kCrf, search.settings));
    if (images.size() < 2 || !codec.ok()) return estimated;
    const auto bytes = (*codec)->encode(images);
    if (!bytes.ok()) return estimated;
    ENGRAM_ASSIGN_OR_RETURN(const double first, seconds_to_decode(**codec, *bytes, images, 1));
    ENGRAM_ASSIGN_OR_RETURN(const double all,
                            seconds_to_decode(**codec, *bytes, images, images.size()));
    const double per_row = std::max(all - first, 0.0) / static_cast<double>(images.size() - 1);
    decoding.per_row += per_row;
    decoding.once += std::max(first - per_row, 0.0);
  }
  return decoding;
}

}  // namespace engram::training
