// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/idf/data.h"

namespace engram::ltm {

/// Max plain bytes and max number of arrays of a group. Decoding one array decodes them all.
inline constexpr uint64_t kMaxGroupBytes = uint64_t{512} << 20;
inline constexpr uint64_t kMaxGroupImages = 1024;

/// The place of an array in an encoded group.
struct GroupPlace {
  uint32_t index = 0;
  uint32_t count = 1;  ///< Number of arrays in the group.
};

/// An ndarray that was taken out of its value and encoded by a codec.
struct PackedMedium {
  std::string path;   ///< Its place in the value.
  std::string codec;  ///< Name of the codec (ltm/codec/codec.h).
  idf::ElementType type = idf::ElementType::kUInt8;
  idf::Shape shape;
  Buffer bytes;
  /// Set if `codec` is a group codec (ltm/codec/group_codec.h). `bytes` then contain the whole
  /// group and are shared by all of its arrays.
  std::optional<GroupPlace> group = std::nullopt;
};

/// A value in stored form: its media are encoded separately, the rest is unchanged.
struct PackedValue {
  idf::Data rest;  ///< The value with `none` where media were.
  std::vector<PackedMedium> media;
};

/// The kind of an array, as far as its element type and shape determine it.
enum class MediumKind {
  kImage,   ///< An image as defined by ltm/idf/layout.h, except depth.
  kDepth,   ///< float32 or uint16 [H, W, 1] with H, W of at least 8.
  kCloud,   ///< float32 [N, 3 to 16] with N of at least 8.
  kArray,   ///< Any other.
  kNumber,  ///< In rules only: numbers and arrays that stay in the value.
};

[[nodiscard]] MediumKind medium_kind(idf::ElementType type, const idf::Shape& shape);

/// A rule for how some arrays are stored.
struct PackRule {
  /// Pattern of their paths: `*` matches any characters except `/`, `**` matches any characters,
  /// `?` matches one character except `/`.
  std::string path = "**";
  /// Their kind; nullopt matches any kind.
  std::optional<MediumKind> kind;
  /// Text of a codec (ltm/codec/codec_text.h), or "none" to keep the arrays in the value. With a
  /// group codec, arrays are recorded singly and grouped when they are sealed
  /// (ltm/codec/seal_rules.h). For numbers it is "columns" or "none".
  std::string codec;
  /// The lossless codec with which arrays for a group codec are recorded. Empty: "rowpred", or
  /// "png" for arrays that "rowpred" does not accept.
  std::string journal = {};
};

struct PackOptions {
  /// The first matching rule applies. An array that its codec does not accept is stored with
  /// "shuffle".
  std::vector<PackRule> rules;
  /// Codec for images and depth without a matching rule. Images that it does not accept are stored
  /// with "zstd".
  std::string image_codec = "png";
  /// Codec for other arrays without a matching rule.
  std::string array_codec = "shuffle";
  /// Such arrays that are smaller than this stay in the value, as plain datasets of segments. Unit:
  /// bytes.
  size_t min_array_bytes = 64 << 10;

  /// Errors: kInvalidArgument if a codec is unknown, a rule contradicts itself or a path is empty;
  /// kFailedPrecondition if the encoder of a group codec is not installed.
  [[nodiscard]] Status validate() const;
};

/// Packs values. Its codecs are created once.
///
/// Threading: immutable, const-parallel.
class Packer {
 public:
  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<Packer> create(const PackOptions& options);

  /// Errors: kInvalidArgument if a codec fails.
  Result<PackedValue> pack(const idf::Data& value) const;

 private:
  struct Plan;
  explicit Packer(std::shared_ptr<const Plan> plan) : plan_(std::move(plan)) {}

  std::shared_ptr<const Plan> plan_;
};

/// Packs one value. Errors: those of Packer.
Result<PackedValue> pack(const idf::Data& value, const PackOptions& options);

class MediumDecoder;

/// Decodes the media and puts them back into the value. Errors: kDataLoss if media do not decode to
/// what was packed.
Result<idf::Data> unpack(const PackedValue& packed, MediumDecoder& decoder);
Result<idf::Data> unpack(const PackedValue& packed);

/// Converts a medium of a group into a single one, without further loss.
/// Errors: those of MediumDecoder.
Result<PackedMedium> pack_alone(const PackedMedium& medium, MediumDecoder& decoder);

/// True if `pattern`, in the form of PackRule::path, matches `path`. Complexity: O(product of the
/// sizes).
[[nodiscard]] bool matches_path(std::string_view pattern, std::string_view path);

}  // namespace engram::ltm
