// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the reader of 7-Scenes folders.

#include <filesystem>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Returns true if a folder has frames, or folders seq-XX.
[[nodiscard]] bool is_seven_scenes(const std::filesystem::path& folder);

/// Reads the sequences of a scene one after the other.
///
/// Memory: one frame, and the numbers of the frames of one sequence.
class SevenScenesReader final : public RecordingReader {
 public:
  /// Errors: kInvalidArgument if the folder has no frame; kNotFound if a requested sequence is
  /// missing.
  static Result<std::unique_ptr<RecordingReader>> open(const std::filesystem::path& folder,
                                                       const ReadingOptions& options);

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return 0; }
  Result<std::optional<Moment>> next() override;

 private:
  SevenScenesReader(const ReadingOptions& options, double rate_hz)
      : gap_(options.episode_gap), rate_hz_(rate_hz), start_(options.start.value_or(Time())) {}

  Status add_stream(std::string_view segment, const std::string& name,
                    const ReadingOptions& options, idf::Dict attributes);
  void add(size_t stream, Time time, std::optional<idf::Data> value, ltm::Commit& commit);

  std::vector<RecordingStream> streams_;
  std::vector<std::filesystem::path> sequences_;
  Duration gap_;
  double rate_hz_;
  Time start_;  ///< The start of the current sequence.
  size_t sequence_ = 0;
  std::vector<uint32_t> frames_;  ///< Frames of the current sequence; empty if not yet listed.
  size_t frame_ = 0;
};

}  // namespace engram::datasets
