// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: how records of an audit log are sealed.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "ltm/core/status.h"
#include "server/access/token.h"

namespace engram::server {

/// A line is never longer. Unit: bytes.
inline constexpr size_t kMaxAuditLine = size_t{32} << 10;

/// Where a chain of records goes on.
///
/// Each record is sealed with a key of its own, from which the next one is made, and which is then
/// overwritten. So whoever takes over a machine cannot change what was written before: its keys are
/// gone. Source: B. Schneier, J. Kelsey, "Secure Audit Logs to Support Computer Forensics" (1999),
/// section 3; docs/access.md, "The audit log".
struct AuditLink {
  uint64_t record = 0;  ///< Number of the next record.
  TokenHash key{};      ///< Seals it.
  TokenHash seal{};     ///< Of the record before; zeros before the first one.
  uint64_t bytes = 0;   ///< Of the log before it.

  /// The first link of a log whose first key was made of `secret`.
  static AuditLink first(std::string_view secret);

  /// Seals a record: returns its line, with a line break. `fields` is JSON without braces.
  [[nodiscard]] std::string line_of(std::string_view fields) const;

  /// Whether a line, without its line break, was sealed with this key; where it follows is not
  /// looked at.
  [[nodiscard]] bool fits(std::string_view line) const;

  /// Whether it is the next record, as a server wrote it.
  [[nodiscard]] bool is_next(std::string_view line) const;

  /// Goes on to the next record. `line` is the one of this record, with its line break.
  void advance(std::string_view line);

  /// Goes on over a record whose line is not known.
  void skip();
};

/// What a line of a log says of itself.
struct AuditLine {
  uint64_t record = 0;
  TokenHash before{};  ///< Seal of the record before.
  TokenHash seal{};
};

/// Splits a line, without its line break; nothing if it is none of an audit log.
[[nodiscard]] std::optional<AuditLine> parse_audit_line(std::string_view line);

/// The text of the state of a log, with a checksum. It always has the same length.
[[nodiscard]] std::string to_text(const AuditLink& link);

/// Reads the file of a state, which only its owner may read.
/// Errors: kNotFound, kUnavailable, kFailedPrecondition; kDataLoss if it is none.
Result<AuditLink> read_audit_state(const std::filesystem::path& path);

}  // namespace engram::server
