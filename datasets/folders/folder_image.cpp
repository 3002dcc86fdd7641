// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/folder_image.h"

#include <algorithm>

#include "ltm/codec/codec.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

/// Whether a name of a table stays in its folder.
bool stays_inside(const std::filesystem::path& name) {
  return name.is_relative() && std::ranges::find(name, "..") == name.end();
}

/// Type and shape that a PNG file announces; nothing for kinds that are not read.
std::optional<std::pair<idf::ElementType, idf::Shape>> announced(std::span<const std::byte> file) {
  const auto at = [&](size_t i) { return std::to_integer<int64_t>(file[i]); };
  const auto word = [&](size_t i) {
    return at(i) << 24 | at(i + 1) << 16 | at(i + 2) << 8 | at(i + 3);
  };
  if (file.size() < 26 || at(0) != 0x89 || at(1) != 'P') return std::nullopt;
  const bool is_colour = at(25) == 2;
  if (!is_colour && at(25) != 0) return std::nullopt;
  return std::pair(at(24) == 16 ? idf::ElementType::kUInt16 : idf::ElementType::kUInt8,
                   idf::Shape{word(20), word(16), is_colour ? 3 : 1});
}

}  // namespace

std::optional<idf::Data> folder_image(const std::filesystem::path& folder,
                                      const std::filesystem::path& name, bool is_depth) {
  if (!stays_inside(name)) return std::nullopt;
  const auto file = read_file(folder / name);
  const auto found = file.ok() ? announced(file->bytes()) : std::nullopt;
  if (!found || (found->first == idf::ElementType::kUInt16) != is_depth) return std::nullopt;
  auto image = ltm::find_codec("png")->decode(file->bytes(), found->first, found->second);
  if (!image.ok()) return std::nullopt;
  return idf::Dict{{is_depth ? "depth" : "image", *std::move(image)}};
}

}  // namespace engram::datasets
