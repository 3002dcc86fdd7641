// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/disk_encryption.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <fstream>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram {
namespace {

/// A machine as /proc and /sys tell of it, and a folder on one of its disks.
class DiskOfFolder : public ::testing::Test {
 protected:
  DiskOfFolder() {
    std::filesystem::create_directories(proc_ / "self");
    std::filesystem::create_directories(sys_ / "dev/block");
    std::filesystem::create_directories(folder_);
    mount("/", "ext4", "/dev/none");
    struct stat about {};
    EXPECT_EQ(::stat(folder_.c_str(), &about), 0);
    own_number_ = fmt::format("{}:{}", major(about.st_dev), minor(about.st_dev));
  }

  void mount(const std::string& point, const std::string& kind, const std::string& source) {
    std::ofstream(proc_ / "self/mounts", std::ios::app)
        << source << " " << point << " " << kind << " rw,noatime 0 0\n";
  }

  /// A block device, made of others. Its ID in the device mapper may be empty.
  std::filesystem::path block(const std::string& number, const std::string& name,
                              const std::string& mapper_id,
                              const std::vector<std::string>& below = {}) {
    const auto device = sys_ / "devices" / name;
    std::filesystem::create_directories(device / "slaves");
    if (!mapper_id.empty()) {
      std::filesystem::create_directories(device / "dm");
      std::ofstream(device / "dm/uuid") << mapper_id << "\n";
    }
    for (const std::string& slave : below)
      std::filesystem::create_directory_symlink(
          sys_ / "devices" / slave, device / "slaves" / std::filesystem::path(slave).filename());
    std::filesystem::create_directory_symlink(device, sys_ / "dev/block" / number);
    return device;
  }

  Result<DiskState> state() { return find_disk_state(folder_, proc_, sys_); }

  ScratchDirectory scratch_;
  std::filesystem::path proc_ = std::filesystem::canonical(scratch_.path()) / "proc";
  std::filesystem::path sys_ = std::filesystem::canonical(scratch_.path()) / "sys";
  std::string own_number_;  ///< Of the disk that the folder really lies on.
  std::filesystem::path folder_ = std::filesystem::canonical(scratch_.path()) / "a home/store";
};

TEST_F(DiskOfFolder, IsEncryptedWhereADeviceBelowItIs) {
  // A volume on an encrypted partition, as installers make it.
  block("8:2", "sda2", "");
  block("253:0", "dm-0", "CRYPT-LUKS2-0123-sda2_crypt", {"sda2"});
  block(own_number_, "dm-1", "LVM-abc", {"dm-0"});
  const std::string point = (scratch_.path() / "a home").string();
  std::string escaped = std::filesystem::canonical(point).string();
  escaped.replace(escaped.find(' '), 1, "\\040");
  mount(escaped, "ext4", "/dev/mapper/no-home");
  const auto found = state();
  ASSERT_OK(found);
  EXPECT_EQ(found->encryption, DiskEncryption::kEncrypted);
  EXPECT_EQ(found->device, "/dev/mapper/no-home");
  EXPECT_EQ(found->filesystem, "ext4");
}

TEST_F(DiskOfFolder, IsPlainWhereNoneIs) {
  const auto disk = block(own_number_, "sda/sda1", "");
  std::ofstream(disk / "partition") << "1\n";
  const auto found = state();
  ASSERT_OK(found);
  EXPECT_EQ(found->encryption, DiskEncryption::kPlain);
}

TEST_F(DiskOfFolder, IsUnknownWhereNobodyTells) {
  EXPECT_EQ(state()->encryption, DiskEncryption::kUnknown) << "no such block device";
  mount("/", "tmpfs", "tmpfs");
  EXPECT_EQ(state()->encryption, DiskEncryption::kUnknown);
  mount("/", "fuse.gocryptfs", "/cipher");
  EXPECT_EQ(state()->encryption, DiskEncryption::kEncrypted);
  EXPECT_FAILS(find_disk_state(folder_ / "none", proc_, sys_), StatusCode::kNotFound, "none");
  EXPECT_FAILS(find_disk_state(folder_, sys_, sys_), StatusCode::kUnavailable, "no mount");
}

TEST_F(DiskOfFolder, EndsWhereDevicesAreMadeOfThemselves) {
  block(own_number_, "dm-9", "LVM-x", {"dm-9"});
  EXPECT_EQ(state()->encryption, DiskEncryption::kPlain);
}

TEST(DiskEncryption, OfThisMachineIsTold) {
  const auto found = find_disk_state("/");
  ASSERT_OK(found);
  EXPECT_FALSE(found->reason.empty());
}

}  // namespace
}  // namespace engram
