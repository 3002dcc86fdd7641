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

/// The most plain bytes and arrays of a group: who wants one of them decodes them all.
inline constexpr uint64_t kMaxGroupBytes = uint64_t{512} << 20;
inline constexpr uint64_t kMaxGroupImages = 1024;

/// Which array of an encoded group.
struct GroupPlace {
  uint32_t index = 0;
  uint32_t count = 1;  ///< Of the group's arrays.
};

/// An ndarray that left its value and went through a codec.
struct PackedMedium {
  std::string path;   ///< Where it belongs in the value.
  std::string codec;  ///< Name of the codec (ltm/codec/codec.h).
  idf::ElementType type = idf::ElementType::kUInt8;
  idf::Shape shape;
  Buffer bytes;
  /// Where `codec` is a group codec (ltm/codec/group_codec.h): then `bytes` are those of the whole
  /// group, which all of its arrays share.
  std::optional<GroupPlace> group = std::nullopt;
};

/// A value as it is stored: its media encoded apart, the rest as it was.
struct PackedValue {
  idf::Data rest;  ///< The value with `none` where media were.
  std::vector<PackedMedium> media;
};

/// What an array is, as far as its element type and shape tell.
enum class MediumKind {
  kImage,   ///< What a layout calls an image (ltm/idf/layout.h), but for depth.
  kDepth,   ///< float32 or uint16 [H, W, 1] with H, W of at least 8.
  kCloud,   ///< float32 [N, 3 to 16] with N of at least 8.
  kArray,   ///< Any other.
  kNumber,  ///< In rules only: numbers and arrays that stay in the value.
};

[[nodiscard]] MediumKind medium_kind(idf::ElementType type, const idf::Shape& shape);

/// Says how some arrays are stored.
struct PackRule {
  /// Their paths: `*` stands for any characters but `/`, `**` for any, `?` for one but `/`.
  std::string path = "**";
  /// Their kind; nothing: any.
  std::optional<MediumKind> kind;
  /// Text of a codec (ltm/codec/codec_text.h), or "none": they stay in the value. That of a group
  /// codec: they are recorded singly, and put together when they are sealed
  /// (ltm/codec/seal_rules.h). For numbers: "columns" or "none".
  std::string codec;
  /// How arrays for a group codec are recorded, without loss. Empty: by "rowpred", or where that
  /// does not accept them by "png".
  std::string journal = {};
};

struct PackOptions {
  /// The first one that fits an array counts. An array that its codec does not accept goes through
  /// "shuffle".
  std::vector<PackRule> rules;
  /// For images and depth that no rule fits; what it does not accept goes through "zstd".
  std::string image_codec = "png";
  /// For other arrays that no rule fits.
  std::string array_codec = "shuffle";
  /// Smaller ones of these stay in the value, as plain datasets of segments. Unit: bytes.
  size_t min_array_bytes = 64 << 10;

  /// Errors: kInvalidArgument where a codec is unknown, a rule contradicts itself or a path is
  /// empty; kFailedPrecondition where the encoder of a group codec is not installed.
  [[nodiscard]] Status validate() const;
};

/// Packs values, with its codecs made once.
///
/// Threading: immutable, const-parallel.
class Packer {
 public:
  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<Packer> create(const PackOptions& options);

  /// Errors: kInvalidArgument where a codec fails.
  Result<PackedValue> pack(const idf::Data& value) const;

 private:
  struct Plan;
  explicit Packer(std::shared_ptr<const Plan> plan) : plan_(std::move(plan)) {}

  std::shared_ptr<const Plan> plan_;
};

/// Packs one value. Errors: those of Packer.
Result<PackedValue> pack(const idf::Data& value, const PackOptions& options);

class MediumDecoder;

/// Errors: kDataLoss where media do not decode to what was packed.
Result<idf::Data> unpack(const PackedValue& packed, MediumDecoder& decoder);
Result<idf::Data> unpack(const PackedValue& packed);

/// A medium of a group as one by itself: what it decodes to, without further loss.
/// Errors: those of MediumDecoder.
Result<PackedMedium> pack_alone(const PackedMedium& medium, MediumDecoder& decoder);

/// True where `pattern` of PackRule::path stands for `path`. Complexity: O(product of the sizes).
[[nodiscard]] bool matches_path(std::string_view pattern, std::string_view path);

}  // namespace engram::ltm
