// SPDX-License-Identifier: Apache-2.0
// Where a vault and its keys may lie, who may read and change them, and one process at a time.
#include <fcntl.h>
#include <unistd.h>

#include <barrier>
#include <future>

#include "datasets/vault/vault_mark.h"
#include "datasets/vault/wiped_file.h"
#include "tests/datasets/vault/vault_fixture.h"

namespace engram::datasets::vault {
namespace {

class VaultAtPlaces : public VaultFixture {};

TEST_F(VaultAtPlaces, RefusesKeysThatOthersMayReadOrThatLieInTheVault) {
  make_store();
  exported();
  namespace fs = std::filesystem;
  EXPECT_EQ(fs::status(places_.keys).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  for (const auto others :
       {fs::perms::group_read, fs::perms::others_read, fs::perms::group_write}) {
    fs::permissions(places_.keys, others, fs::perm_options::add);
    EXPECT_FAILS(try_export(), StatusCode::kFailedPrecondition, "chmod 600");
    EXPECT_FAILS(check_vault(places_, {}, {}), StatusCode::kFailedPrecondition, "chmod 600");
    EXPECT_FAILS(import_from_vault(places_, scratch_ / "back", {}, {}),
                 StatusCode::kFailedPrecondition, "chmod 600");
    fs::permissions(places_.keys, others, fs::perm_options::remove);
  }
  EXPECT_OK(try_export());
  const auto keys_path = places_.keys;
  fs::create_directory(scratch_ / "folder");
  fs::create_symlink(places_.vault, scratch_ / "link");
  for (const auto& inside : {places_.vault / "robot.keys", places_.vault / ".." / "vault" / "k",
                             scratch_ / "link" / "robot.keys",
                             scratch_ / "folder" / ".." / "link" / "deep" / "robot.keys"}) {
    places_.keys = inside;
    EXPECT_FAILS(try_export(), StatusCode::kFailedPrecondition, "inside the vault");
  }
  places_.keys = keys_path;
  EXPECT_EQ(names().size(), 10U);
}

TEST_F(VaultAtPlaces, DestroysNoKeyThatItCouldNotOverwrite) {
  make_store();
  exported();
  namespace fs = std::filesystem;
  const std::string before = content(places_.keys);
  // Root, too: whoever may open the file all the same was told not to change it.
  fs::permissions(places_.keys, fs::perms::owner_read);
  EXPECT_FAILS(VaultFolder::open_keys(places_), StatusCode::kFailedPrecondition, "needs the perm");
  EXPECT_FAILS(try_export(), StatusCode::kFailedPrecondition, "chmod 600");
  EXPECT_TRUE(checked().is_whole()) << "reading needs no more";
  fs::permissions(places_.keys, fs::perms::owner_write, fs::perm_options::add);
  // It became so while the keys were open.
  auto folder = VaultFolder::open_keys(places_);
  ASSERT_OK(folder);
  fs::permissions(places_.keys, fs::perms::owner_read);
  EXPECT_FAILS(folder->destroy({{camera(), kFirstDay}}, system_now()),
               StatusCode::kFailedPrecondition, "could not be overwritten");
  EXPECT_EQ(content(places_.keys), before);
  EXPECT_FALSE(fs::exists(places_.keys.string() + ".replacing"));
}

TEST_F(VaultAtPlaces, ReplacesNoSecretThatItCannotOpen) {
  // A link is not followed, so that what it points to stays: that is no success.
  const auto secret = scratch_ / "secret", link = scratch_ / "link";
  ASSERT_OK(replace_secret_file(secret, as_bytes("the old key")));
  std::filesystem::create_symlink(secret, link);
  EXPECT_FAILS(replace_secret_file(link, as_bytes("the new key")), StatusCode::kUnavailable,
               "to overwrite it");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(content(secret), "the old key");
  EXPECT_FALSE(std::filesystem::exists(link.string() + ".replacing"));
  ASSERT_OK(replace_secret_file(secret, as_bytes("the new key")));
  EXPECT_EQ(content(secret), "the new key");
}

TEST_F(VaultAtPlaces, RefusesTheKeysOfAnotherVault) {
  make_store();
  exported();
  VaultPlaces other{scratch_ / "other", scratch_ / "other.keys"};
  std::swap(places_, other);
  exported();
  std::swap(places_.keys, other.keys);
  for (const StatusCode code :
       {try_export().status().code(), check_vault(places_, {}, {}).status().code(),
        VaultFolder::open_keys(places_).status().code()})
    EXPECT_EQ(code, StatusCode::kFailedPrecondition);
  places_.keys = scratch_ / "missing.keys";
  EXPECT_FAILS(try_export(), StatusCode::kFailedPrecondition, "needs the one");
  EXPECT_FALSE(std::filesystem::exists(places_.keys));
  EXPECT_FAILS(check_vault(places_, {}, {}), StatusCode::kNotFound, "missing.keys");
}

TEST_F(VaultAtPlaces, RefusesADirectoryWithOtherFiles) {
  make_store();
  std::filesystem::create_directory(places_.vault);
  EXPECT_OK(replace_file(places_.vault / "letter.txt", as_bytes("dear diary")));
  EXPECT_FAILS(try_export(), StatusCode::kAlreadyExists, "has other files");
  EXPECT_EQ(names(), std::set<std::string>{"letter.txt"});
}

TEST_F(VaultAtPlaces, KeepsThePermissionsOfADirectoryThatIsThere) {
  make_store();
  namespace fs = std::filesystem;
  const auto for_group = fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec;
  fs::create_directory(places_.vault);
  fs::permissions(places_.vault, for_group);
  exported();
  EXPECT_EQ(fs::status(places_.vault).permissions(), for_group);
  places_ = {scratch_ / "new", scratch_ / "new.keys"};
  exported();
  EXPECT_EQ(fs::status(places_.vault).permissions(), fs::perms::owner_all);
  fs::permissions(places_.vault, for_group);
  exported();
  EXPECT_EQ(fs::status(places_.vault).permissions(), for_group);
}

TEST_F(VaultAtPlaces, AMarkOfATerabyteIsNotReadWhole) {
  make_store();
  exported();
  std::filesystem::resize_file(places_.vault / "engram.vault", uint64_t{1} << 40);
  EXPECT_FAILS(read_vault_id(places_.vault), StatusCode::kDataLoss, "is damaged");
  EXPECT_OK(try_export());
  EXPECT_EQ(std::filesystem::file_size(places_.vault / "engram.vault"), 28U);
}

TEST_F(VaultAtPlaces, AnOlderCopyOfTheKeysRemovesNothingNewer) {
  make_store();
  exported("Body @ all");
  std::filesystem::copy_file(places_.keys, scratch_ / "copy.keys");
  exported();
  places_.keys = scratch_ / "copy.keys";
  EXPECT_EQ(checked().without_key, 6U);
  exported("Body");
  EXPECT_EQ(names().size(), 10U);
}

TEST_F(VaultAtPlaces, OneProcessChangesItAtATime) {
  make_store();
  exported();
  const auto first = VaultFolder::open(places_);
  ASSERT_OK(first);
  EXPECT_FAILS(VaultFolder::open(places_), StatusCode::kFailedPrecondition, "another process");
  EXPECT_TRUE(checked().is_whole()) << "reading needs no lock";
}

TEST_F(VaultAtPlaces, OneOfTwoCopiesOfTheKeysChangesItAtATime) {
  make_store();
  exported();
  std::filesystem::copy_file(places_.keys, scratch_ / "copy.keys");
  const VaultPlaces copy{places_.vault, scratch_ / "copy.keys"};
  {
    const auto first = VaultFolder::open(places_);
    ASSERT_OK(first);
    EXPECT_FAILS(VaultFolder::open(copy), StatusCode::kFailedPrecondition, "another process");
    // Nobody can hold up the destruction of keys, but the files are the other's now.
    auto folder = VaultFolder::open_keys(copy);
    ASSERT_OK(folder);
    ASSERT_OK(folder->destroy({{camera(), kFirstDay}}, system_now()));
    EXPECT_FALSE(folder->is_within_reach());
    EXPECT_EQ(names().size(), 10U);
  }
  EXPECT_OK(VaultFolder::open(copy));
  EXPECT_EQ(names().size(), 9U);
  // Also where the mark was damaged, and is written anew.
  overwrite(places_.vault / "engram.vault", "garbage");
  const auto first = VaultFolder::open(copy);
  ASSERT_OK(first);
  EXPECT_FAILS(VaultFolder::open(places_), StatusCode::kFailedPrecondition, "another process");
}

TEST_F(VaultAtPlaces, OneOfTwoThatMakeItAtOnceIsRefused) {
  for (int round = 0; round < 50; ++round) {
    const std::string name = std::to_string(round);
    const auto vault = scratch_ / ("vault" + name);
    std::filesystem::create_directory(vault);
    std::barrier start(2);
    const auto make = [&](const std::string& keys) {
      start.arrive_and_wait();
      return VaultFolder::open({vault, scratch_ / (keys + name)});
    };
    auto other = std::async(std::launch::async, make, "b.keys");
    const auto one = make("a.keys");
    const auto two = other.get();
    ASSERT_NE(one.ok(), two.ok()) << one.status().to_string() << '\n' << two.status().to_string();
    const auto made = one.ok() ? one->keys().vault : two->keys().vault;
    EXPECT_EQ(*read_vault_id(vault), made);
  }
}

TEST_F(VaultAtPlaces, LeftoversOfAKilledReplacementAreWiped) {
  make_store();
  exported();
  const std::string old = content(places_.keys);
  const auto left = places_.keys.string() + ".replaced";
  overwrite(left, old);
  std::filesystem::permissions(left, std::filesystem::status(places_.keys).permissions());
  const int inode = ::open(left.c_str(), O_RDONLY);
  exported();
  EXPECT_FALSE(std::filesystem::exists(left));
  std::string bytes(old.size(), '\0');
  EXPECT_EQ(::pread(inode, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(old.size()));
  ::close(inode);
  EXPECT_EQ(bytes.find("ENGRAMVK"), std::string::npos);
  // A kill before the rename left a second name of the file itself, which must stay whole.
  std::filesystem::create_hard_link(places_.keys, left);
  exported();
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(checked().is_whole());
}

}  // namespace
}  // namespace engram::datasets::vault
