// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "ltm/core/status.h"

namespace engram::server {

/// What somebody asked of a server, and whether it was let.
struct AuditEvent {
  std::string server;   ///< Name of the server that was asked.
  std::string who;      ///< Name of a token's holder; empty: nobody known.
  std::string did;      ///< "query", "predict", "subscribe", "share", "commit", "declare", ...
  std::string on;       ///< Query, entity or segment.
  std::string refused;  ///< Why it was refused; empty: it was let.
};

/// A log of who asked what of servers, in which no record can be changed, left out or put in
/// without a trace: each names the seal of the one before, and is sealed with a key of its own that
/// is overwritten afterwards.
///
/// A log at PATH is a text with a line of JSON for each record. PATH.state tells the server where
/// it goes on. PATH.key has the secret that verifies the log, and belongs elsewhere: who has it can
/// write a log anew.
///
/// What was added survives a killed process, and after a second a power cut.
/// Owns: a thread.
/// Threading: thread-safe.
/// Source: docs/access.md, "The audit log".
class AuditLog {
 public:
  /// Makes an empty log, its state and its key.
  /// Errors: kAlreadyExists if one of the files is there; kResourceExhausted, kUnavailable.
  static Status create(const std::filesystem::path& path);

  /// Opens a log to add to it. Where a killed process left a record whole or in parts, it goes on
  /// from there; where the log is not as the state says, it warns and goes on, and
  /// check_audit_log() tells.
  /// Errors: kNotFound if create() has to come first; kFailedPrecondition if another process adds
  /// to it, or if others can read its state; kDataLoss if the state is damaged; kUnavailable.
  static Result<std::unique_ptr<AuditLog>> open(const std::filesystem::path& path);

  /// The files of a log at `path`: where it goes on, and the secret that verifies it.
  [[nodiscard]] static std::filesystem::path state_path(const std::filesystem::path& path);
  [[nodiscard]] static std::filesystem::path key_path(const std::filesystem::path& path);

  /// Writes what is still counted.
  ~AuditLog();

  /// Adds a record. Refusals that repeat one of the same holder and kind within a second are
  /// counted, and told by the next record of them, so that who is refused cannot fill the disk.
  /// What an event is about is cut at 4 KiB.
  /// Errors: kResourceExhausted if the disk is full, kUnavailable. What was asked should be refused
  /// then.
  Status add(const AuditEvent& event);

 private:
  struct State;
  explicit AuditLog(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::server
