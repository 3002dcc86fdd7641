// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "ltm/memory/commit.h"

namespace engram::testing {

inline constexpr const char* kLeft = "Vision/RGB/head/left";
inline constexpr const char* kRight = "Vision/RGB/head/right";

/// An image whose pixels all tell its time, so that parts of two images cannot be taken for one.
inline ltm::Commit image_commit(const std::string& entity, int64_t at, size_t bytes = 20'000) {
  const auto value = static_cast<uint8_t>(at % 251);
  idf::Data image =
      idf::NdArray::take({static_cast<int64_t>(bytes)}, std::vector<uint8_t>(bytes, value));
  return {{{*ltm::MemoryId::parse(entity), time_from_ns(at), {{std::move(image), {}}}}}};
}

/// Whether a value is an image of this time, and whole.
inline bool is_whole_image(const idf::Data& data, int64_t at) {
  const auto* image = data.get_if<idf::NdArray>();
  if (image == nullptr || image->bytes().empty()) return false;
  return std::ranges::all_of(image->bytes(),
                             [at](std::byte one) { return one == std::byte(at % 251); });
}

}  // namespace engram::testing
