// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the reader of all dialects.

#include <map>

#include "datasets/hdf5/dialect.h"
#include "datasets/hdf5/row_blocks.h"
#include "datasets/recordings/moment_order.h"

namespace engram::datasets {

/// Reads episodes one after the other, and the arrays of an episode row by row.
///
/// Memory: a block of each array of an episode, and the names of all arrays.
class EpisodesReader final : public RecordingReader {
 public:
  /// `files` must be in the order of their episodes and of the same dialect.
  /// Errors: kInvalidArgument if a file has no episode, a requested one is missing, or times do not
  /// fit; those of h5::File.
  static Result<std::unique_ptr<RecordingReader>> open(
      const Dialect& dialect, const std::vector<std::filesystem::path>& files,
      const ReadingOptions& options);

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return total_; }
  Result<std::optional<Moment>> next() override;

 private:
  struct Array {
    size_t stream = 0;
    RowRole role = RowRole::kValues;
  };
  struct Episode {
    std::filesystem::path file;
    EpisodeGroup group;
    double rate_hz = 0;
    std::vector<std::string> arrays;  ///< Names of the arrays.
    std::vector<std::string> groups;  ///< Names of the groups inside of the episode.
  };

  EpisodesReader(const Dialect& dialect, ReadingOptions options)
      : dialect_(dialect), options_(std::move(options)) {}

  Status add_file(const std::filesystem::path& path);
  Status add_episode(const h5::File& file, const EpisodeGroup& group, double rate_hz);
  Status list_arrays(const h5::File& file, Episode& episode, const std::string& below, int depth);
  Status list_array(const h5::File& file, Episode& episode, const std::string& name);
  Status add_array(const std::string& name, const h5::ArrayInfo& info);
  Status check_asked() const;

  Status begin_episode();
  Result<RecordingEpisode> describe_episode();
  Result<Time> time_of(uint64_t row) const;

  const Dialect& dialect_;
  ReadingOptions options_;
  std::vector<RecordingStream> streams_;
  std::map<std::string, Array, std::less<>> arrays_;
  FreeEntities entities_;
  std::vector<Episode> episodes_;
  uint64_t total_ = 0;

  size_t episode_ = 0;  ///< The current episode, or the next one if !is_begun_.
  bool is_begun_ = false;
  std::optional<h5::File> file_;
  std::vector<std::pair<size_t, RowBlocks>> blocks_;  ///< Arrays with the index of their stream.
  uint64_t row_ = 0;
  uint64_t rows_ = 0;  ///< Rows of the longest array of the episode.
  Time start_{};
};

}  // namespace engram::datasets
