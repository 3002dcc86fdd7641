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
#include "server/access/rate_limit.h"
#include "server/access/token.h"

namespace engram::server {

/// What a caller may do. Each role includes the ones before it.
enum class Role : uint8_t {
  kRead,   ///< Query and subscribe.
  kWrite,  ///< Commit and declare types.
  kAdmin,  ///< Forget, change limits and stop the server.
};

/// "read", "write", "admin".
[[nodiscard]] std::string_view to_string(Role role);

/// The holder of a token, and what that holder may do.
///
/// Owns: a share of the policy's entry, which stays unchanged if the policy is replaced.
/// Threading: thread-safe.
class Identity {
 public:
  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] Role role() const;

  /// Checks that the holder has a role for an ID, and that the token has not expired.
  /// Errors: kFailedPrecondition naming the holder, the role and the ID, never the token.
  [[nodiscard]] Status check(Role needed, const ltm::MemoryId& id) const;

  /// Filters the answers of queries with patterns: whether the holder may read this entity, or what
  /// lies below this ID. Nothing once the token has expired.
  [[nodiscard]] bool may_read(const ltm::MemoryId& id) const;

  /// Counts a request against the rate of the token.
  /// Errors: kResourceExhausted if the rate is exceeded; kFailedPrecondition if it has expired.
  [[nodiscard]] Status take_request(SteadyTime now) const;

 private:
  friend class AccessPolicy;
  struct Grant;
  explicit Identity(std::shared_ptr<const Grant> grant) : grant_(std::move(grant)) {}

  std::shared_ptr<const Grant> grant_;
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

  /// Whether this is everyone(): callers then cannot be distinguished.
  [[nodiscard]] bool is_everyone() const { return everyone_ != nullptr; }

  /// Returns the holder of a token.
  /// Errors: kFailedPrecondition if the token is unknown or has expired.
  Result<Identity> authenticate(std::string_view token) const;

 private:
  using Grants = std::vector<std::shared_ptr<const Identity::Grant>>;
  explicit AccessPolicy(Grants grants) : grants_(std::move(grants)) {}

  static Result<std::shared_ptr<const Identity::Grant>> read_grant(
      const ConfigValue& config, const std::filesystem::path& directory, SteadyTime now);

  Grants grants_;
  std::shared_ptr<const Identity::Grant> everyone_;  ///< Set only for everyone().
};

}  // namespace engram::server
