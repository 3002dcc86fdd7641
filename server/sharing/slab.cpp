// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/slab.h"

#include <fcntl.h>
#include <sys/mman.h>

namespace engram::server {

namespace {

/// The flag MFD_NOEXEC_SEAL of Linux 6.3: some systems refuse memory that could be executed.
constexpr unsigned kNeverExecuted = 8;

constexpr int kFixedSize = F_SEAL_SHRINK | F_SEAL_GROW;

int make_memory() {
  const unsigned flags = MFD_CLOEXEC | MFD_ALLOW_SEALING;
  const int fd = ::memfd_create("engram", flags | kNeverExecuted);
  return fd < 0 && errno == EINVAL ? ::memfd_create("engram", flags) : fd;
}

}  // namespace

Result<std::shared_ptr<Mapping>> Mapping::make(int fd, size_t bytes, bool is_writable) {
  const int access = is_writable ? PROT_READ | PROT_WRITE : PROT_READ;
  void* const start = ::mmap(nullptr, bytes, access, MAP_SHARED, fd, 0);
  if (start == MAP_FAILED) return system_status("shared memory: cannot map");
  return std::shared_ptr<Mapping>(
      new Mapping({static_cast<std::byte*>(start), bytes}, is_writable));
}

Mapping::~Mapping() {
  ::munmap(bytes_.data(), bytes_.size());
}

std::span<std::byte> Mapping::writable() const {
  ENGRAM_CHECK(is_writable_, "the mapping is for reading alone");
  return bytes_;
}

Result<Slab> Slab::create(size_t bytes, bool is_ours) {
  Descriptor memory(make_memory());
  if (!memory.is_open()) return system_status("shared memory: cannot make");
  if (::ftruncate(memory.get(), static_cast<off_t>(bytes)) != 0)
    return system_status("shared memory: cannot size");
  if (::fcntl(memory.get(), F_ADD_SEALS, kFixedSize) != 0)
    return system_status("shared memory: cannot seal");
  ENGRAM_ASSIGN_OR_RETURN(auto mapping, Mapping::make(memory.get(), bytes, is_ours));
  Slab slab(std::move(memory), std::move(mapping));
  if (is_ours) ENGRAM_RETURN_IF_ERROR(slab.seal());
  return slab;
}

Status Slab::seal() {
  if (is_sealed_) return {};
  // The call fails if the writer set seals of its own; what matters is which seals are set.
  ::fcntl(memory_.get(), F_ADD_SEALS, F_SEAL_FUTURE_WRITE | F_SEAL_SEAL);
  constexpr int kNeeded = kFixedSize | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL;
  const int seals = ::fcntl(memory_.get(), F_GET_SEALS);
  if ((seals & kNeeded) != kNeeded)
    return failed_precondition("shared memory: found seals {:#x}, needs {:#x}", seals, kNeeded);
  const std::string path = fmt::format("/proc/self/fd/{}", memory_.get());
  Descriptor reading(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!reading.is_open()) return system_status("shared memory: cannot open for reading");
  memory_ = std::move(reading);
  is_sealed_ = true;
  return {};
}

Result<Descriptor> Slab::descriptor() const {
  Descriptor copy(::fcntl(memory_.get(), F_DUPFD_CLOEXEC, 0));
  if (!copy.is_open()) return system_status("shared memory: cannot duplicate");
  return copy;
}

}  // namespace engram::server
