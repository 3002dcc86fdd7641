// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ltm/redaction/detector.h"

namespace engram::ltm {

/// Asks an external program, by its standard input and output.
///
/// The program writes `{"ready": true}` and a line end once it can answer. Then it gets one header
/// for each image, a line of JSON
///   {"image": NUMBER, "entity": TEXT, "member": TEXT, "time_ns": N, "width": W, "height": H,
///    "channels": 1 or 3, "bytes": N}
/// followed by that many bytes of pixels, and answers with one line {"image": NUMBER, "boxes": [[x,
/// y, width, height], ...]} in pixels. It ends at the end of its input.
///
/// A program that dies, gives no answer in time or writes anything else is killed, and started
/// again after a pause, which doubles from 0.1 s to 30 s until it answers again. Until it is ready
/// no image has an answer. It is killed with this object, and by the kernel if this process dies.
/// Threading: thread-safe; one image after the other. A thread of its own starts the program and
/// waits for its end.
/// Source: docs/recording.md, section "Redaction".
class ProgramDetector final : public Detector {
 public:
  struct Options {
    /// The program, which is searched on the path, and its arguments.
    std::vector<std::string> command;
    /// The time in which it has to answer, from the header on.
    Duration timeout = std::chrono::seconds(2);
    /// The time in which it has to be ready after its start.
    Duration start_timeout = std::chrono::seconds(30);

    [[nodiscard]] Status validate() const;
    friend bool operator==(const Options&, const Options&) = default;
  };

  /// Starts the program and waits until it is ready.
  /// Errors: kInvalidArgument; kNotFound if there is no such program; kFailedPrecondition if it
  /// ended or said something else, or nothing in time.
  static Result<std::unique_ptr<Detector>> create(const Options& options);
  ~ProgramDetector() override;

  [[nodiscard]] std::string_view name() const override { return "program"; }
  Result<std::vector<Box>> find(const DetectorImage& image) override;
  Status wait_ready(const std::stop_token& stop) override;

  /// How often the program was started.
  [[nodiscard]] uint64_t starts() const;

 private:
  struct State;
  explicit ProgramDetector(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
