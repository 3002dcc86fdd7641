// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "augmentation/blender/scene.h"
#include "ltm/core/time.h"

namespace engram::augmentation {

/// A renderer that runs Blender: one process renders any number of scenes.
///
/// Light comes straight from the lamps and the surroundings, without bounces, so a changed thing
/// changes only its own pixels and its shadow. Equal scenes and options give equal images on one
/// machine.
/// Owns: the process and a temporary folder.
/// Threading: one thread.
class Blender {
 public:
  struct Options {
    /// The program to run. If empty, ENGRAM_BLENDER names it, else "blender" is looked up on the
    /// path.
    std::string program;
    /// Maximum number of samples per pixel, 1 to 4096.
    int samples = 64;
    /// The threshold of noise below which a pixel gets no more samples. A larger value is quicker,
    /// but then a change also shows in the noise around it. 0 gives all samples to all pixels.
    double noise = 0;
    int threads = 2;
    /// How long to wait for one scene.
    Duration patience = std::chrono::minutes(5);
  };

  /// Errors: kInvalidArgument for options; kNotFound if there is no Blender, saying how to get it;
  /// kUnavailable if it does not start.
  static Result<std::unique_ptr<Blender>> start(const Options& options);
  ~Blender();

  /// "3.4.1".
  [[nodiscard]] const std::string& version() const;

  /// Renders one scene. Shape: uint8 [height, width, 3], RGB.
  /// Errors: kInvalidArgument if the scene does not validate; kUnavailable with Blender's message.
  Result<idf::NdArray> render(const Scene& scene);

 private:
  struct State;
  explicit Blender(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::augmentation
