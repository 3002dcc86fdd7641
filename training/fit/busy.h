// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace engram::training {

/// Knows whether somebody else needs the processors now.
///
/// Threading: one thread.
class Busy {
 public:
  virtual ~Busy() = default;

  /// Why they are needed, as a reader would say it; nothing where they are free. Never waits.
  [[nodiscard]] virtual std::optional<std::string> reason() = 0;
};

}  // namespace engram::training
