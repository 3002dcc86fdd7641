// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>

#include "ltm/core/status.h"

namespace engram::cli {

/// A pipe that a child writes. The read end is not inherited by other children.
///
/// Owns: both of its ends.
/// Threading: one thread.
class ChildPipe {
 public:
  ChildPipe() = default;
  ChildPipe(const ChildPipe&) = delete;
  ChildPipe& operator=(const ChildPipe&) = delete;
  ~ChildPipe() { close(); }

  /// Errors: kUnavailable with the reason of the system.
  Status open();
  void close();
  void close_write_end() { close_end(1); }

  [[nodiscard]] int read_end() const { return ends_[0]; }
  [[nodiscard]] int write_end() const { return ends_[1]; }
  /// False once all has been read that the child wrote.
  [[nodiscard]] bool is_open() const { return ends_[0] >= 0; }
  /// Whether read_into() returns at once.
  [[nodiscard]] bool has_bytes() const;

  /// Appends the bytes that are there, after waiting for some, and closes the pipe at its end.
  void read_into(std::string& text);

 private:
  void close_end(size_t end);

  std::array<int, 2> ends_{-1, -1};
};

/// The lines of what a child writes, without their breaks.
///
/// Threading: one thread.
class ChildLines {
 public:
  /// Reads once, and tells each whole line; at the end of the pipe what is left too.
  void read(ChildPipe& pipe, const std::function<void(const std::string& line)>& tell);
  void clear() { text_.clear(); }

 private:
  std::string text_;  ///< An incomplete line.
};

}  // namespace engram::cli
