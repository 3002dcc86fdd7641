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
/// Threading: immutable. What lies in it changes as its writer likes.
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

/// Memory without a name, of a size that nobody can change. Its writer maps it; then it is sealed,
/// and nobody else can ever map it for writing, whoever holds a descriptor of it.
///
/// Threading: one thread; the mapping from any.
/// Source: docs/sharing.md, "Who can do what".
class Slab {
 public:
  /// One that the server writes is sealed; one of a client waits for seal().
  /// Errors: kResourceExhausted, kUnavailable.
  static Result<Slab> create(size_t bytes, bool is_ours);

  /// Errors: kFailedPrecondition where somebody made it impossible, kUnavailable.
  Status seal();
  [[nodiscard]] bool is_sealed() const { return is_sealed_; }

  /// To hand to another process: for writing until it is sealed, then for reading.
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
