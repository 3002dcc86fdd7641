// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram {

enum class DiskEncryption {
  kEncrypted,
  kPlain,
  kUnknown,  ///< The system does not tell, as of network disks and of containers.
};

/// "encrypted", "not encrypted", "unknown".
[[nodiscard]] std::string_view to_string(DiskEncryption encryption);

/// What the disk of a file is.
struct DiskState {
  std::string device;      ///< "/dev/mapper/home", or what a file system without one is called.
  std::string filesystem;  ///< "ext4".
  DiskEncryption encryption = DiskEncryption::kUnknown;
  std::string reason;  ///< In words.
};

/// Finds out whether the disk that `path` lies on is encrypted: whether its block device, or one
/// that it is made of, is a device of dm-crypt (LUKS), or its file system encrypts by itself.
/// Encryption of single folders (fscrypt) is not seen.
/// Errors: kNotFound; kUnavailable if the system tells nothing about mounts.
/// Source: getmntent(3); Linux, Documentation/ABI/stable/sysfs-block and testing/sysfs-block-dm.
Result<DiskState> find_disk_state(const std::filesystem::path& path,
                                  const std::filesystem::path& proc = "/proc",
                                  const std::filesystem::path& sys = "/sys");

}  // namespace engram
