// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/disk_encryption.h"

#include <fmt/format.h>
#include <mntent.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

namespace engram {

namespace {

namespace fs = std::filesystem;

/// Devices are made of others, and those of others again.
constexpr int kMaxDepth = 8;

struct Mount {
  std::string point, filesystem, source;
};

bool lies_below(const std::string& path, const std::string& point) {
  if (point == "/") return true;
  return path.starts_with(point) && (path.size() == point.size() || path[point.size()] == '/');
}

/// The mount that a path lies on: the deepest one, and the last of those at one point.
std::optional<Mount> mount_of(const std::string& path, const fs::path& proc) {
  const auto close = [](std::FILE* file) { ::endmntent(file); };
  const std::unique_ptr<std::FILE, decltype(close)> file(
      ::setmntent((proc / "self/mounts").c_str(), "re"), close);
  std::optional<Mount> found;
  mntent entry{};
  std::vector<char> texts(size_t{16} << 10);
  while (file && ::getmntent_r(file.get(), &entry, texts.data(), static_cast<int>(texts.size()))) {
    const std::string point = entry.mnt_dir;
    if (lies_below(path, point) && (!found || point.size() >= found->point.size()))
      found = Mount{point, entry.mnt_type, entry.mnt_fsname};
  }
  return found;
}

std::string content_of(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// Whether a block device, or one of those that it is made of, is one of dm-crypt.
bool is_crypt(const fs::path& block, int depth) {
  if (depth > kMaxDepth) return false;
  if (content_of(block / "dm/uuid").starts_with("CRYPT-")) return true;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(block / "slaves", none)) {
    const fs::path slave = fs::canonical(entry.path(), none);
    if (!none && is_crypt(slave, depth + 1)) return true;
  }
  // A partition is in the folder of its disk.
  return fs::exists(block / "partition", none) && is_crypt(block.parent_path(), depth + 1);
}

/// The number of the block device that a mount is of: "253:0". Some file systems give their files a
/// number of their own, so the source of the mount is asked first.
std::string block_number(const Mount& mount, const fs::path& path) {
  struct stat about {};
  dev_t device = 0;
  if (::stat(mount.source.c_str(), &about) == 0 && S_ISBLK(about.st_mode))
    device = about.st_rdev;
  else if (::stat(path.c_str(), &about) == 0)
    device = about.st_dev;
  return fmt::format("{}:{}", major(device), minor(device));
}

bool encrypts_itself(std::string_view filesystem) {
  constexpr std::array kNames{"ecryptfs", "fuse.gocryptfs", "fuse.encfs", "fuse.cryfs"};
  return std::ranges::find(kNames, filesystem) != kNames.end();
}

}  // namespace

std::string_view to_string(DiskEncryption encryption) {
  switch (encryption) {
    case DiskEncryption::kEncrypted:
      return "encrypted";
    case DiskEncryption::kPlain:
      return "not encrypted";
    case DiskEncryption::kUnknown:
      break;
  }
  return "unknown";
}

Result<DiskState> find_disk_state(const fs::path& path, const fs::path& proc, const fs::path& sys) {
  std::error_code failed;
  const fs::path whole = fs::canonical(path, failed);
  if (failed) return not_found("'{}': {}", path.string(), failed.message());
  const auto mount = mount_of(whole.string(), proc);
  if (!mount)
    return unavailable("'{}': found no mount of it in '{}'", path.string(),
                       (proc / "self/mounts").string());
  DiskState state{mount->source, mount->filesystem, DiskEncryption::kUnknown, ""};
  if (encrypts_itself(mount->filesystem)) {
    state.encryption = DiskEncryption::kEncrypted;
    state.reason = "its file system encrypts";
    return state;
  }
  if (mount->filesystem == "tmpfs" || mount->filesystem == "ramfs") {
    state.reason = "it lies in memory, and in what that is swapped to";
    return state;
  }
  const fs::path block = fs::canonical(sys / "dev/block" / block_number(*mount, whole), failed);
  if (failed) {
    state.reason = "its file system lies on no block device of this machine";
    return state;
  }
  const bool is_encrypted = is_crypt(block, 0);
  state.encryption = is_encrypted ? DiskEncryption::kEncrypted : DiskEncryption::kPlain;
  state.reason = is_encrypted ? "its device is one of dm-crypt"
                              : "neither its device nor one below it is one of dm-crypt";
  return state;
}

}  // namespace engram
