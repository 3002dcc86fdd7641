// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/slab.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <string>

namespace engram::server {
namespace {

constexpr size_t kBytes = 1 << 20;

bool can_map_for_writing(int fd) {
  void* const start = ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (start == MAP_FAILED) return false;
  ::munmap(start, kBytes);
  return true;
}

TEST(Slab, HasASizeThatNobodyCanChange) {
  const auto slab = Slab::create(kBytes, false);
  ASSERT_TRUE(slab.ok()) << slab.status().to_string();
  const auto memory = slab->descriptor();
  ASSERT_TRUE(memory.ok());
  EXPECT_NE(::ftruncate(memory->get(), 0), 0);
  EXPECT_NE(::ftruncate(memory->get(), 2 * kBytes), 0);
}

TEST(Slab, ShowsWhatItsWriterWritesAfterItWasSealed) {
  auto slab = Slab::create(kBytes, false);
  const auto memory = slab->descriptor();
  const auto writing = Mapping::make(memory->get(), kBytes, true);
  ASSERT_TRUE(writing.ok());
  ASSERT_TRUE(slab->seal().ok());
  ASSERT_TRUE(slab->seal().ok());
  (*writing)->writable()[5000] = std::byte{17};
  EXPECT_EQ(slab->mapping()->data()[5000], std::byte{17});
}

TEST(Slab, CannotBeMappedForWritingOnceItIsSealed) {
  auto slab = Slab::create(kBytes, false);
  const auto earlier = slab->descriptor();
  ASSERT_TRUE(can_map_for_writing(earlier->get()));
  ASSERT_TRUE(slab->seal().ok());
  const auto later = slab->descriptor();
  EXPECT_FALSE(can_map_for_writing(earlier->get()));
  EXPECT_FALSE(can_map_for_writing(later->get()));
  EXPECT_LT(::write(earlier->get(), "x", 1), 0);
  // Its owner may make it writable for all, and open it once more: that does not help.
  ::fchmod(later->get(), 0666);
  const std::string path = "/proc/self/fd/" + std::to_string(later->get());
  const Descriptor reopened(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (reopened.is_open()) {
    EXPECT_FALSE(can_map_for_writing(reopened.get()));
    EXPECT_LT(::write(reopened.get(), "x", 1), 0);
    EXPECT_NE(::fallocate(reopened.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, 4096), 0);
  }
}

TEST(Slab, CannotBeMadeWritableWhereItIsMappedForReading) {
  const auto slab = Slab::create(kBytes, true);
  const auto memory = slab->descriptor();
  void* const start = ::mmap(nullptr, kBytes, PROT_READ, MAP_SHARED, memory->get(), 0);
  ASSERT_NE(start, MAP_FAILED);
  EXPECT_NE(::mprotect(start, kBytes, PROT_READ | PROT_WRITE), 0);
  ::munmap(start, kBytes);
}

TEST(Slab, IsRefusedWhereItsWriterForbadeToSealIt) {
  auto slab = Slab::create(kBytes, false);
  const auto memory = slab->descriptor();
  ASSERT_EQ(::fcntl(memory->get(), F_ADD_SEALS, F_SEAL_SEAL), 0);
  EXPECT_EQ(slab->seal().code(), StatusCode::kFailedPrecondition);
  EXPECT_FALSE(slab->is_sealed());
}

TEST(Slab, OfTheServerIsSealedFromTheStart) {
  const auto slab = Slab::create(kBytes, true);
  ASSERT_TRUE(slab->is_sealed());
  slab->mapping()->writable()[0] = std::byte{1};
  EXPECT_EQ(slab->mapping()->data()[0], std::byte{1});
}

TEST(Slab, OfMoreThanTheSystemHasIsRefused) {
  EXPECT_FALSE(Slab::create(SIZE_MAX / 2, false).ok());
}

}  // namespace
}  // namespace engram::server
