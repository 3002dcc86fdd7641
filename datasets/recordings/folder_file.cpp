// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/folder_file.h"

#include <algorithm>

namespace engram::datasets {

namespace {

/// Returns the folder in the hub's cache that the links of a snapshot point to; else empty.
std::filesystem::path blobs_of(const std::filesystem::path& folder) {
  const auto snapshots = folder.parent_path();
  return snapshots.filename() == "snapshots" ? snapshots.parent_path() / "blobs"
                                             : std::filesystem::path();
}

}  // namespace

bool is_inside(const std::filesystem::path& folder, const std::filesystem::path& path) {
  return std::ranges::mismatch(folder, path).in1 == folder.end();
}

Result<std::filesystem::path> file_in_folder(const std::filesystem::path& folder,
                                             const std::filesystem::path& name) {
  if (name.empty() || !name.is_relative() || std::ranges::find(name, "..") != name.end())
    return invalid_argument("'{}': found the name '{}', needs one inside of the folder",
                            folder.string(), name.string());
  const std::filesystem::path path = folder / name;
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  if (kind == std::filesystem::file_type::not_found)
    return not_found("'{}': there is no such file", path.string());
  if (kind != std::filesystem::file_type::regular)
    return invalid_argument("'{}': is no file", path.string());
  const auto real_folder = std::filesystem::canonical(folder, error);
  const auto real_path = error ? std::filesystem::path() : std::filesystem::canonical(path, error);
  if (error) return unavailable("'{}': {}", path.string(), error.message());
  const auto blobs = blobs_of(real_folder);
  if (is_inside(real_folder, real_path) || (!blobs.empty() && is_inside(blobs, real_path)))
    return path;
  return invalid_argument("'{}': is a link to '{}', needs a file inside of '{}'", path.string(),
                          real_path.string(), folder.string());
}

}  // namespace engram::datasets
