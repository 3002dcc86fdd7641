// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// Turns several arrays of one type and shape, in the order of time, into one self-contained
/// blob. Whatever they share is stored once; reading any of them decodes the blob from its start.
///
/// Threading: const-parallel.
/// Source: docs/codecs.md, section "Groups".
class GroupCodec {
 public:
  virtual ~GroupCodec() = default;

  /// The name that is stored with the bytes: never changes. Decoding needs no options.
  [[nodiscard]] virtual std::string_view name() const = 0;

  [[nodiscard]] virtual bool is_lossless() const = 0;

  /// See Codec::psnr_db.
  [[nodiscard]] virtual double psnr_db() const = 0;

  /// How many arrays a blob should hold: more take fewer bytes, but longer to reach.
  [[nodiscard]] virtual size_t group_size() const = 0;

  [[nodiscard]] virtual bool accepts(idf::ElementType type, const idf::Shape& shape) const = 0;

  /// Equal groups give equal bytes.
  /// Errors: kInvalidArgument where there is no array, they differ in type or shape, or it does
  /// not accept them; kResourceExhausted where memory is used up.
  virtual Result<std::vector<std::byte>> encode(std::span<const idf::NdArray> arrays) const = 0;

  /// Decodes a group of exactly `count` arrays of this type and shape. Safe on hostile bytes.
  /// Errors: kDataLoss where the bytes hold anything else; kFailedPrecondition where the decoder
  /// is not installed.
  virtual Result<std::vector<idf::NdArray>> decode(std::span<const std::byte> bytes,
                                                   idf::ElementType type, const idf::Shape& shape,
                                                   size_t count) const = 0;
};

/// The names of all group codecs, installed or not.
[[nodiscard]] std::span<const std::string_view> group_codec_names();

/// Those whose encoders are installed.
[[nodiscard]] std::vector<std::string_view> available_group_codecs();

/// True where the text of a rule's codec means groups. `ffv1` is a codec for single images, too: it
/// does where it says how large they are.
/// Errors: kInvalidArgument where the text is malformed.
Result<bool> means_groups(std::string_view text);

/// Decodes what was stored under `name`; null where there is none of this name.
[[nodiscard]] const GroupCodec* find_group_codec(std::string_view name);

/// A group codec by its name and options: "ffv1", "h264:crf=23,group=30".
/// Errors: kInvalidArgument naming the codecs there are, the option or its range;
/// kFailedPrecondition where the encoder is not installed.
Result<std::shared_ptr<const GroupCodec>> make_group_codec(std::string_view text);

}  // namespace engram::ltm
