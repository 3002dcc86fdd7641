// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/config.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/memory/sight.h"
#include "ltm/redaction/redaction_options.h"
#include "server/access/rate_limit.h"
#include "server/access/right.h"
#include "server/access/token.h"

namespace engram::server {

/// The holder of a token, and what that holder may do.
///
/// Owns: a share of the policy's entry, which stays unchanged if the policy is replaced.
/// Threading: thread-safe.
/// Source: docs/access.md, "Grants".
class Identity {
 public:
  [[nodiscard]] const std::string& name() const;

  /// Checks that the holder may do something with an ID and what lies below it, at some time at
  /// least, and that the token has not expired.
  /// Errors: kFailedPrecondition naming the holder, the right and the ID, never the token.
  [[nodiscard]] Status check(Right needed, const ltm::MemoryId& id) const;

  /// The same for a snapshot of this time.
  [[nodiscard]] Status check(Right needed, const ltm::MemoryId& id, Time time) const;

  /// Checks that the holder may do something with an ID or with something that lies below it.
  [[nodiscard]] Status check_below(Right needed, const ltm::MemoryId& id) const;

  /// Whether the holder may read all that lies below an ID, of all times, as it is.
  [[nodiscard]] bool may_read_all(const ltm::MemoryId& id) const;

  /// What the holder sees: nothing once the token has expired. Null for who sees everything for
  /// ever.
  [[nodiscard]] ltm::SharedView view() const;

  /// What the holder may erase, as if it were what can be seen. Null for who may erase everything
  /// for ever.
  [[nodiscard]] ltm::SharedView erasable() const;

  /// Counts a request against the rate of the token.
  /// Errors: kResourceExhausted if the rate is exceeded; kFailedPrecondition if it has expired.
  [[nodiscard]] Status take_request(SteadyTime now) const;

 private:
  friend class AccessPolicy;
  class Holder;
  class Erasable;
  explicit Identity(std::shared_ptr<const Holder> holder) : holder_(std::move(holder)) {}

  std::shared_ptr<const Holder> holder_;
};

/// Decides who may do what, from the tokens file of docs/access.md.
///
/// Only the SHA-256 of each token is kept. A given token is compared with all of them in constant
/// time.
/// Threading: thread-safe.
class AccessPolicy {
 public:
  static constexpr size_t kMaxTokens = 1000;
  static constexpr size_t kMaxTokenBytes = 1024;
  /// The min length of a token read from a file: shorter ones can be guessed.
  static constexpr size_t kFewestTokenBytes = 32;

  /// A policy under which everyone may do everything, with or without a token. It is for servers
  /// without a tokens file that only this machine can reach.
  static AccessPolicy everyone();

  /// Reads a tokens file. The rate limits start at `now`.
  /// Errors: kNotFound, kUnavailable; kFailedPrecondition if others can read the file or a token's
  /// file; kInvalidArgument naming file, line and key.
  static Result<AccessPolicy> read_file(const std::filesystem::path& path,
                                        SteadyTime now = steady_now());

  /// Like read_file(), from a parsed text. Relative paths of token files start at `directory`.
  static Result<AccessPolicy> parse(const ConfigValue& config,
                                    const std::filesystem::path& directory, SteadyTime now);

  /// How images are redacted for who may only see them so; nothing where there is nobody.
  [[nodiscard]] const std::optional<ltm::RedactionOptions>& redaction() const { return redaction_; }

  /// Whether this is everyone(): callers then cannot be distinguished.
  [[nodiscard]] bool is_everyone() const { return everyone_ != nullptr; }

  /// Returns the holder of a token.
  /// Errors: kFailedPrecondition if the token is unknown or has expired.
  Result<Identity> authenticate(std::string_view token) const;

 private:
  using SharedHolder = std::shared_ptr<const Identity::Holder>;
  explicit AccessPolicy(std::vector<SharedHolder> holders) : holders_(std::move(holders)) {}

  static Result<SharedHolder> read_holder(const ConfigValue& config,
                                          const std::filesystem::path& directory, SteadyTime now);

  std::vector<SharedHolder> holders_;
  std::optional<ltm::RedactionOptions> redaction_;
  SharedHolder everyone_;  ///< Set only for everyone().
};

}  // namespace engram::server
