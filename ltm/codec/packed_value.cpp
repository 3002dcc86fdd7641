// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/packed_value.h"

#include <algorithm>
#include <array>

#include "ltm/codec/codec.h"
#include "ltm/codec/medium_decoder.h"
#include "ltm/codec/pack_rule_use.h"
#include "ltm/codec/seal_rules.h"
#include "ltm/codec/zstd_codec.h"
#include "ltm/idf/layout.h"

namespace engram::ltm {

namespace {

constexpr int64_t kMinSide = 8;
/// Codecs for single images; the first one that accepts an image is used.
constexpr std::array<std::string_view, 3> kLosslessCodecs{"rowpred", "png", "shuffle"};

/// Null if the arrays stay in the value.
using ChosenCodec = std::shared_ptr<const Codec>;

Result<ChosenCodec> make_chosen(const std::string& text) {
  if (text == kStays) return ChosenCodec();
  return make_codec(text);
}

const Codec& lossless_codec(idf::ElementType type, const idf::Shape& shape) {
  for (const std::string_view name : kLosslessCodecs)
    if (const Codec* codec = find_codec(name); codec->accepts(type, shape)) return *codec;
  return zstd_codec();
}

bool is_picture(MediumKind kind) {
  return kind == MediumKind::kImage || kind == MediumKind::kDepth;
}

}  // namespace

struct Packer::Plan {
  struct Rule {
    std::string path;
    std::optional<MediumKind> kind;
    ChosenCodec codec;
    bool is_for_groups = false;  ///< A null codec then stands for a lossless one.

    [[nodiscard]] const Codec* choose(const idf::TensorMember& member) const {
      if (codec != nullptr && codec->accepts(member.type, member.shape)) return codec.get();
      if (is_for_groups) return &lossless_codec(member.type, member.shape);
      // "shuffle" accepts every array, so an array that the rule's codec does not accept never
      // stops a recording.
      return codec == nullptr ? nullptr : find_codec("shuffle");
    }
  };

  /// The codec of an array, or null if it stays in the value.
  [[nodiscard]] const Codec* choose(const idf::TensorMember& member, size_t bytes) const {
    const MediumKind kind = medium_kind(member.type, member.shape);
    for (const Rule& rule : rules) {
      if ((rule.kind && *rule.kind != kind) || !matches_path(rule.path, member.path)) continue;
      return rule.choose(member);
    }
    if (member.kind == idf::MemberKind::kImage || is_picture(kind)) {
      if (image == nullptr || image->accepts(member.type, member.shape)) return image.get();
      // The image codec does not accept it: it is float depth, or too large.
      return member.kind == idf::MemberKind::kImage ? &zstd_codec() : array.get();
    }
    return bytes >= min_array_bytes ? array.get() : nullptr;
  }

  std::vector<Rule> rules;
  ChosenCodec image;
  ChosenCodec array;
  size_t min_array_bytes = 0;
};

MediumKind medium_kind(idf::ElementType type, const idf::Shape& shape) {
  using enum idf::ElementType;
  if (shape.size() == 3 && shape[0] >= kMinSide && shape[1] >= kMinSide) {
    if (shape[2] == 1 && (type == kFloat32 || type == kUInt16)) return MediumKind::kDepth;
    if (type == kUInt8 && (shape[2] == 1 || shape[2] == 3)) return MediumKind::kImage;
  }
  const bool is_cloud = type == kFloat32 && shape.size() == 2 && shape[0] >= kMinSide &&
                        shape[1] >= 3 && shape[1] <= 16;
  return is_cloud ? MediumKind::kCloud : MediumKind::kArray;
}

bool matches_path(std::string_view pattern, std::string_view path) {
  // ends[i] is true if the pattern so far matches the first i characters of the path. Unlike
  // backtracking, this takes no longer on patterns with many stars.
  std::vector<bool> ends(path.size() + 1, false);
  ends[0] = true;
  for (size_t p = 0; p < pattern.size(); ++p) {
    const bool is_deep = pattern.substr(p).starts_with("**");
    const bool is_star = pattern[p] == '*';
    if (is_star) {
      for (size_t i = 0; i < path.size(); ++i)
        if (ends[i] && (is_deep || path[i] != '/')) ends[i + 1] = true;
      if (is_deep) ++p;
      continue;
    }
    for (size_t i = path.size(); i > 0; --i)
      ends[i] =
          ends[i - 1] && (pattern[p] == path[i - 1] || (pattern[p] == '?' && path[i - 1] != '/'));
    ends[0] = false;
  }
  return ends[path.size()];
}

Status PackOptions::validate() const {
  ENGRAM_RETURN_IF_ERROR(SealRules::create(*this).status());
  return Packer::create(*this).status();
}

Result<Packer> Packer::create(const PackOptions& options) {
  auto plan = std::make_shared<Plan>();
  for (const PackRule& rule : options.rules) {
    if (rule.path.empty())
      return invalid_argument("rule for codec '{}': path is empty", rule.codec);
    ENGRAM_ASSIGN_OR_RETURN(const PackRuleUse use, use_of(rule));
    if (use == PackRuleUse::kNumbers) continue;
    const bool is_for_groups = use == PackRuleUse::kGroup;
    const std::string& text = is_for_groups ? rule.journal : rule.codec;
    ENGRAM_ASSIGN_OR_RETURN(auto codec, text.empty() ? ChosenCodec() : make_chosen(text));
    plan->rules.push_back({rule.path, rule.kind, std::move(codec), is_for_groups});
  }
  ENGRAM_ASSIGN_OR_RETURN(plan->image, make_chosen(options.image_codec));
  ENGRAM_ASSIGN_OR_RETURN(plan->array, make_chosen(options.array_codec));
  plan->min_array_bytes = options.min_array_bytes;
  return Packer(std::move(plan));
}

Result<PackedValue> Packer::pack(const idf::Data& value) const {
  PackedValue packed{value, {}};
  const idf::Layout layout = idf::Layout::of(value);
  for (const idf::TensorMember& member : layout.members()) {
    if (member.kind != idf::MemberKind::kImage && member.kind != idf::MemberKind::kArray) continue;
    const auto& array = value.at(member.path)->get<idf::NdArray>();
    const Codec* codec = plan_->choose(member, array.bytes().size());
    if (codec == nullptr) continue;
    auto bytes = codec->encode(array);
    if (!bytes.ok()) return bytes.status().with_context("member '" + member.path + "'");
    packed.media.push_back({member.path, std::string(codec->name()), member.type, member.shape,
                            Buffer::take(std::move(bytes).value())});
    *packed.rest.at(member.path) = idf::None{};
  }
  return packed;
}

Result<PackedValue> pack(const idf::Data& value, const PackOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const Packer packer, Packer::create(options));
  return packer.pack(value);
}

Result<idf::Data> unpack(const PackedValue& packed, MediumDecoder& decoder) {
  idf::Data value = packed.rest;
  for (const PackedMedium& medium : packed.media) {
    idf::Data* place = value.at(medium.path);
    if (place == nullptr || !place->is<idf::None>())
      return data_loss("member '{}': the value has no place for it", medium.path);
    auto array = decoder.decode(medium);
    if (!array.ok()) return array.status().with_context("member '" + medium.path + "'");
    *place = std::move(array).value();
  }
  return value;
}

Result<idf::Data> unpack(const PackedValue& packed) {
  MediumDecoder decoder;
  return unpack(packed, decoder);
}

Result<PackedMedium> pack_alone(const PackedMedium& medium, MediumDecoder& decoder) {
  auto array = decoder.decode(medium);
  if (!array.ok()) return array.status().with_context("member '" + medium.path + "'");
  const Codec& codec = lossless_codec(medium.type, medium.shape);
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, codec.encode(*array));
  return PackedMedium{medium.path, std::string(codec.name()), medium.type, medium.shape,
                      Buffer::take(std::move(bytes))};
}

}  // namespace engram::ltm
