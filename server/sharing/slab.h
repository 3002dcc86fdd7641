// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "ltm/core/status.h"
#include "server/sharing/block_ref.h"
#include "server/sharing/descriptor.h"

namespace engram::server {

/// A mapping of shared memory into this process.
///
/// Threading: immutable. The writer may change its contents at any time.
class Mapping {
 public:
  /// Errors: kResourceExhausted, kUnavailable.
  static Result<std::shared_ptr<Mapping>> make(int fd, size_t bytes, bool is_writable);

  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping();

  [[nodiscard]] const std::byte* data() const { return bytes_.data(); }
  [[nodiscard]] size_t size() const { return bytes_.size(); }

  /// Needs is_writable() (checked).
  [[nodiscard]] std::span<std::byte> writable() const;
  [[nodiscard]] bool is_writable() const { return is_writable_; }

 private:
  Mapping(std::span<std::byte> bytes, bool is_writable)
      : bytes_(bytes), is_writable_(is_writable) {}

  std::span<std::byte> bytes_;
  bool is_writable_;
};

/// Anonymous shared memory (memfd) of a fixed size. Once its writer has mapped it, it is sealed,
/// and no other process can ever map it for writing, even with a descriptor of it.
///
/// Threading: one thread; the mapping may be used from any thread.
/// Source: docs/sharing.md, "Who can do what".
class Slab {
 public:
  /// Makes a slab. A slab that the server writes (`is_ours`) is sealed at once; one of a client
  /// waits for seal().
  /// Errors: kResourceExhausted, kUnavailable.
  static Result<Slab> create(size_t bytes, bool is_ours);

  /// Seals the slab against new writable mappings.
  /// Errors: kFailedPrecondition if a process has made sealing impossible; kUnavailable.
  Status seal();
  [[nodiscard]] bool is_sealed() const { return is_sealed_; }

  /// Returns a descriptor for another process: for writing until the slab is sealed, then for
  /// reading.
  /// Errors: kResourceExhausted, kUnavailable.
  [[nodiscard]] Result<Descriptor> descriptor() const;

  [[nodiscard]] const std::shared_ptr<Mapping>& mapping() const { return mapping_; }

 private:
  Slab(Descriptor memory, std::shared_ptr<Mapping> mapping)
      : memory_(std::move(memory)), mapping_(std::move(mapping)) {}

  Descriptor memory_;
  std::shared_ptr<Mapping> mapping_;
  bool is_sealed_ = false;
};

}  // namespace engram::server
