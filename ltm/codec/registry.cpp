// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <limits>
#include <string>

#include "ltm/codec/codec.h"
#include "ltm/codec/jpeg.h"
#include "ltm/codec/png.h"
#include "ltm/codec/rowpred.h"
#include "ltm/codec/shuffle_codec.h"
#include "ltm/codec/video_codec.h"
#include "ltm/codec/zstd_codec.h"

namespace engram::ltm {

namespace {

struct Maker {
  std::string_view name;
  Result<std::unique_ptr<const Codec>> (*make)(CodecText text);
};

constexpr std::array<Maker, 6> kMakers{{
    {"png", make_png_codec},
    {"zstd", make_zstd_codec},
    {"rowpred", make_rowpred_codec},
    {"shuffle", make_shuffle_codec},
    {"jpeg", make_jpeg_codec},
    {"ffv1", make_ffv1_image_codec},
}};

std::string known_names() {
  std::string names;
  for (const Maker& maker : kMakers) names += (names.empty() ? "" : ", ") + std::string(maker.name);
  return names;
}

}  // namespace

double Codec::psnr_db() const {
  return std::numeric_limits<double>::infinity();
}

std::span<const Codec* const> all_codecs() {
  static const auto owners = [] {
    std::array<std::unique_ptr<const Codec>, kMakers.size()> made;
    for (size_t i = 0; i < made.size(); ++i)
      made[i] = std::move(kMakers[i].make(*CodecText::parse(kMakers[i].name))).value();
    return made;
  }();
  static const auto codecs = [] {
    std::array<const Codec*, kMakers.size()> all{};
    for (size_t i = 0; i < all.size(); ++i) all[i] = owners[i].get();
    return all;
  }();
  return codecs;
}

const Codec* find_codec(std::string_view name) {
  for (const Codec* codec : all_codecs())
    if (codec->name() == name) return codec;
  return nullptr;
}

Result<std::shared_ptr<const Codec>> make_codec(std::string_view text) {
  ENGRAM_ASSIGN_OR_RETURN(CodecText parsed, CodecText::parse(text));
  for (const Maker& maker : kMakers) {
    if (maker.name != parsed.name()) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto codec, maker.make(std::move(parsed)));
    return std::shared_ptr<const Codec>(std::move(codec));
  }
  return invalid_argument("unknown codec '{}', needs one of: {}", parsed.name(), known_names());
}

}  // namespace engram::ltm
