// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "augmentation/blender/scene.h"
#include "ltm/core/time.h"

namespace engram::augmentation {

/// Blender as a renderer: one process for as many scenes as are asked for.
///
/// Light comes straight from lamps and surroundings, so that a changed thing changes its own pixels
/// and its shadow. Equal scenes and options give equal images on one machine.
/// Owns: the process and a temporary folder.
/// Threading: one thread.
class Blender {
 public:
  struct Options {
    /// Empty: what ENGRAM_BLENDER names, else "blender" on the path.
    std::string program;
    int samples = 64;  ///< Most per pixel. 1 to 4096.
    /// Where a pixel varies less it gets no more samples, which is quicker; but a change then shows
    /// in the noise around it. 0: all pixels get all.
    double noise = 0;
    int threads = 2;
    Duration patience = std::chrono::minutes(5);  ///< With one scene.
  };

  /// Errors: kInvalidArgument for options; kNotFound where there is no Blender, saying how to get
  /// it; kUnavailable where it does not start.
  static Result<std::unique_ptr<Blender>> start(const Options& options);
  ~Blender();

  /// "3.4.1".
  [[nodiscard]] const std::string& version() const;

  /// Shape: uint8 [height, width, 3], RGB.
  /// Errors: kInvalidArgument where the scene does not validate; kUnavailable with Blender's words.
  Result<idf::NdArray> render(const Scene& scene);

 private:
  struct State;
  explicit Blender(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace engram::augmentation
