// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/read_image_file.h"

#include <algorithm>
#include <string>

#include "ltm/codec/image_file.h"
#include "ltm/core/file.h"

namespace engram::datasets {

Result<idf::NdArray> read_image_file(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const Buffer file, read_file(path));
  auto image = ltm::decode_image_file(file.bytes());
  if (!image.ok()) return image.status().with_context(fmt::format("'{}'", path.string()));
  return image;
}

bool has_image_name(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

}  // namespace engram::datasets
