// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <memory>

#include "ltm/core/status.h"

namespace engram::datasets::kitchen {

/// An OpenGL context without a window. It is current in the thread that made it.
///
/// Threading: one thread.
class GlContext {
 public:
  /// Errors: kUnavailable if EGL has no platform without a display, or no OpenGL.
  static Result<std::unique_ptr<GlContext>> create();

  GlContext(const GlContext&) = delete;
  ~GlContext();

 private:
  GlContext() = default;

  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace engram::datasets::kitchen
