// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "encoders/coded_background.h"
#include "encoders/video_reference.h"
#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::encoders {

/// A video as a chain keeps it.
struct StoredVideo {
  ImageForm form = ImageForm::kPackedAv1;
  std::vector<std::byte> bytes;
};

/// The code of a group codec's video: packed if it is of AV1, else as it is.
[[nodiscard]] StoredVideo to_stored_video(std::string_view codec, std::vector<std::byte> group);

/// Decodes the first `wanted` of `count` images of any form of video. It is safe on hostile bytes.
/// Errors: kDataLoss, also if `form` is no video; kFailedPrecondition if the decoder is not
/// installed.
Result<std::vector<idf::NdArray>> decode_stored_video(ImageForm form,
                                                      std::span<const std::byte> bytes,
                                                      const FrameShape& frame, size_t count,
                                                      size_t wanted,
                                                      std::span<const VideoReference> references);

/// How little two images have in common: the mean squared difference of thumbnails.
/// Shape: uint8 [H, W, C], both alike (checked).
[[nodiscard]] double reference_distance(const idf::NdArray& a, const idf::NdArray& b);

/// Packs a group of the codec "av1": without its frame of lengths, and with the heads of its frames
/// modelled (coding/packet_coder.h). If its first packet is the key frame of `reference`, that
/// packet and its image are left out. `reference` may be null.
///
/// Format: a varint of flags (1: 10 bits, 2: begins from a reference), the hash of the reference if
/// there is one, then the packets by PacketCoder, one after the other.
/// Errors: kDataLoss or kInvalidArgument if the bytes are no such group, or begin otherwise than
/// the reference.
Result<std::vector<std::byte>> pack_video(std::span<const std::byte> group,
                                          const VideoReference* reference);

/// Decodes the first `wanted` of `count` images. It is safe on hostile bytes.
/// Errors: kDataLoss, also if none of `references` is the one that the video begins from;
/// kFailedPrecondition if the decoder is not installed.
Result<std::vector<idf::NdArray>> unpack_video(std::span<const std::byte> packed,
                                               const FrameShape& frame, size_t count, size_t wanted,
                                               std::span<const VideoReference> references);

/// The hash of the reference that a packed video begins from, if any.
/// Errors: kDataLoss.
Result<std::optional<uint64_t>> reference_of_video(std::span<const std::byte> packed);

/// A reference with its picture decoded, ready to encode from.
struct OpenReference {
  VideoReference reference;
  idf::NdArray picture;
};

/// Makes a reference of an image: its picture in quality `key` or a little better, and the key
/// frame of that. `settings` are those of the videos that will begin from it, as in
/// "effort=5,depth=10,spread=2": another effort makes other key frames.
/// Errors: those of the codec; kFailedPrecondition if the encoder's key frame depends on what
/// follows it, as that of another version might.
Result<OpenReference> make_reference(const idf::NdArray& image, int key, std::string_view settings);

/// Errors: kDataLoss; kFailedPrecondition if the decoder is not installed.
Result<OpenReference> open_reference(const VideoReference& reference, const FrameShape& frame);

/// Encodes images from a reference as a packed video, with a `crf` above its key. The result is
/// empty if the encoder makes another key frame now.
/// Errors: those of the codec.
Result<std::optional<std::vector<std::byte>>> encode_from(const OpenReference& reference,
                                                          std::span<const idf::NdArray> images,
                                                          int crf, std::string_view settings);

}  // namespace engram::encoders
