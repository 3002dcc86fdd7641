// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "ltm/codec/codec.h"
#include "ltm/codec/png.h"
#include "ltm/codec/zstd_codec.h"

namespace engram::ltm {

std::span<const Codec* const> all_codecs() {
  static const std::array<const Codec*, 2> codecs{&png_codec(), &zstd_codec()};
  return codecs;
}

const Codec* find_codec(std::string_view name) {
  for (const Codec* codec : all_codecs())
    if (codec->name() == name) return codec;
  return nullptr;
}

}  // namespace engram::ltm
