// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace engram::training {

/// Tells whether other work needs the processors now.
///
/// Threading: one thread.
class Busy {
 public:
  virtual ~Busy() = default;

  /// The reason why they are needed, for a message, or nothing if they are free. It never waits.
  [[nodiscard]] virtual std::optional<std::string> reason() = 0;
};

}  // namespace engram::training
