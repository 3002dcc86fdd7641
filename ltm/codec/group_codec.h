// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// Compresses several arrays of one type and shape, in the order of time, into one self-contained
/// blob. Their common content is stored once. Reading any of them decodes the blob from its start.
///
/// Threading: const-parallel.
/// Source: docs/codecs.md, section "Groups".
class GroupCodec {
 public:
  virtual ~GroupCodec() = default;

  /// The name that is stored with the bytes. It never changes. Decoding needs no options.
  [[nodiscard]] virtual std::string_view name() const = 0;

  [[nodiscard]] virtual bool is_lossless() const = 0;

  /// See Codec::psnr_db.
  [[nodiscard]] virtual double psnr_db() const = 0;

  /// Desired number of arrays per blob. More arrays take fewer bytes each, but each takes longer to
  /// reach.
  [[nodiscard]] virtual size_t group_size() const = 0;

  [[nodiscard]] virtual bool accepts(idf::ElementType type, const idf::Shape& shape) const = 0;

  /// Compresses a group. Equal groups give equal bytes.
  /// Errors: kInvalidArgument if there is no array, if the arrays differ in type or shape, or if
  /// the codec does not accept them; kResourceExhausted if memory is exhausted.
  virtual Result<std::vector<std::byte>> encode(std::span<const idf::NdArray> arrays) const = 0;

  /// Decodes a group of exactly `count` arrays of this type and shape. Safe on hostile bytes.
  /// Errors: kDataLoss if the bytes contain anything else; kFailedPrecondition if the decoder is
  /// not installed.
  Result<std::vector<idf::NdArray>> decode(std::span<const std::byte> bytes, idf::ElementType type,
                                           const idf::Shape& shape, size_t count) const {
    return decode_first(bytes, type, shape, count, count);
  }

  /// Decodes the first `wanted` arrays of such a group, at most all (checked). It
  /// takes little longer than they need, and finds no damage beyond them.
  /// Errors: as decode.
  virtual Result<std::vector<idf::NdArray>> decode_first(std::span<const std::byte> bytes,
                                                         idf::ElementType type,
                                                         const idf::Shape& shape, size_t count,
                                                         size_t wanted) const = 0;
};

/// The names of all group codecs, installed or not.
[[nodiscard]] std::span<const std::string_view> group_codec_names();

/// The names of the group codecs whose encoders are installed.
[[nodiscard]] std::vector<std::string_view> available_group_codecs();

/// True if the codec text of a rule means groups. `ffv1` is also a codec for single images; its
/// text means groups if it gives their size.
/// Errors: kInvalidArgument if the text is malformed.
Result<bool> means_groups(std::string_view text);

/// The codec that decodes blobs stored under `name`, or null if there is none of this name.
[[nodiscard]] const GroupCodec* find_group_codec(std::string_view name);

/// Makes a group codec from its name and options: "ffv1", "h264:crf=23,group=30".
/// Errors: kInvalidArgument naming the existing codecs, the option or its range;
/// kFailedPrecondition if the encoder is not installed.
Result<std::shared_ptr<const GroupCodec>> make_group_codec(std::string_view text);

}  // namespace engram::ltm
