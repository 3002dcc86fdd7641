// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/folder_image.h"

#include "datasets/recordings/folder_file.h"
#include "datasets/recordings/read_image_file.h"

namespace engram::datasets {

std::optional<idf::Data> folder_image(const std::filesystem::path& folder,
                                      const std::filesystem::path& name, bool is_depth) {
  const auto path = file_in_folder(folder, name);
  if (!path.ok()) return std::nullopt;
  auto image = read_image_file(*path);
  if (!image.ok() || (image->type() == idf::ElementType::kUInt16) != is_depth) return std::nullopt;
  return idf::Dict{{is_depth ? "depth" : "image", *std::move(image)}};
}

}  // namespace engram::datasets
