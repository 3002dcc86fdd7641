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

/// What somebody may do. Each may do what those before it may.
enum class Role : uint8_t {
  kRead,   ///< Ask.
  kWrite,  ///< Commit, declare types.
  kAdmin,  ///< Forget, change limits, stop the server.
};

/// "read", "write", "admin".
[[nodiscard]] std::string_view to_string(Role role);

/// Whom a token belongs to, and what that one may do.
///
/// Owns: shared with its policy, and stays as it is where the policy is replaced.
/// Threading: thread-safe.
class Identity {
 public:
  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] Role role() const;

  /// Errors: kFailedPrecondition naming who, what and the ID; never the token.
  [[nodiscard]] Status check(Role needed, const ltm::MemoryId& id) const;

  /// For the answers of queries with patterns: whether this entity, or what lies below, is for it.
  [[nodiscard]] bool may_read(const ltm::MemoryId& id) const;

  /// Counts a request.
  /// Errors: kResourceExhausted where there were too many.
  [[nodiscard]] Status take_request(SteadyTime now) const;

 private:
  friend class AccessPolicy;
  struct Grant;
  explicit Identity(std::shared_ptr<const Grant> grant) : grant_(std::move(grant)) {}

  std::shared_ptr<const Grant> grant_;
};

/// Who may do what: the tokens file of docs/access.md.
///
/// Tokens are kept as SHA-256 alone and compared in constant time, each with all of them.
/// Threading: thread-safe.
class AccessPolicy {
 public:
  static constexpr size_t kMaxTokens = 1000;
  static constexpr size_t kMaxTokenBytes = 1024;
  /// Of a token that is read from a file: fewer can be guessed.
  static constexpr size_t kFewestTokenBytes = 32;

  /// Everybody may do everything, with or without a token: for servers that only this machine can
  /// reach and that have no tokens file.
  static AccessPolicy everyone();

  /// `now` is when the limits of rates begin.
  /// Errors: kNotFound, kUnavailable; kFailedPrecondition where others can read the file, or that
  /// of a token; kInvalidArgument naming file, line and key.
  static Result<AccessPolicy> read_file(const std::filesystem::path& path,
                                        SteadyTime now = steady_now());

  /// The same from a text that was read; files of tokens are looked for in `directory`.
  static Result<AccessPolicy> parse(const ConfigValue& config,
                                    const std::filesystem::path& directory, SteadyTime now);

  /// True of everyone(): callers cannot be told apart.
  [[nodiscard]] bool is_everyone() const { return everyone_ != nullptr; }

  /// Errors: kFailedPrecondition where there is no such token.
  Result<Identity> authenticate(std::string_view token) const;

 private:
  using Grants = std::vector<std::shared_ptr<const Identity::Grant>>;
  explicit AccessPolicy(Grants grants) : grants_(std::move(grants)) {}

  static Result<std::shared_ptr<const Identity::Grant>> read_grant(
      const ConfigValue& config, const std::filesystem::path& directory, SteadyTime now);

  Grants grants_;
  std::shared_ptr<const Identity::Grant> everyone_;  ///< Null but for everyone().
};

}  // namespace engram::server
