// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <tuple>

#include "datasets/hdf5/episodes_reader.h"
#include "datasets/hdf5/episodes_writer.h"
#include "datasets/hdf5/hdf5_formats.h"

namespace engram::datasets {

namespace {

bool has_hdf5_name(const std::filesystem::path& path) {
  return path.extension() == ".hdf5" || path.extension() == ".h5";
}

/// Returns the file itself, or the HDF5 files of a folder, with "episode_2.hdf5" before
/// "episode_10.hdf5".
std::vector<std::filesystem::path> files_of(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return {path};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path, error))
    if (has_hdf5_name(entry.path())) files.push_back(entry.path());
  std::ranges::sort(files, {}, [](const std::filesystem::path& file) {
    return std::tuple(file.stem().string().size(), file.string());
  });
  return files;
}

class Hdf5Format final : public RecordingFormat {
 public:
  explicit Hdf5Format(const Dialect& dialect) : dialect_(dialect) {}

  [[nodiscard]] std::string_view name() const override { return dialect_.name(); }
  [[nodiscard]] std::string_view about() const override { return dialect_.about(); }

  [[nodiscard]] bool recognises(const std::filesystem::path& path) const override {
    const auto files = files_of(path);
    if (files.empty() || !has_hdf5_name(files.front())) return false;
    if (!dialect_.has_file_per_episode() && files.front() != path) return false;
    const auto file = h5::File::open(files.front());
    return file.ok() && dialect_.recognises(*file);
  }

  [[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const override {
    std::error_code error;
    if (!std::filesystem::exists(path, error))
      return not_found("'{}': there is no such file or folder", path.string());
    if (std::filesystem::is_directory(path, error) && !dialect_.has_file_per_episode())
      return invalid_argument("'{}': is a folder, {} needs a file", path.string(), name());
    const auto files = files_of(path);
    if (files.empty())
      return invalid_argument("'{}': has no file that ends in .hdf5 or .h5", path.string());
    return EpisodesReader::open(dialect_, files, options);
  }

  [[nodiscard]] bool can_write() const override { return true; }

  [[nodiscard]] Result<NotHeld> not_held(ltm::Recall& recall, const ltm::Query& query,
                                         const WritingOptions& options) const override {
    ENGRAM_ASSIGN_OR_RETURN(EpisodesPlan plan, plan_export(recall, query, options, dialect_));
    return std::move(plan.not_held);
  }

  [[nodiscard]] Result<ExportReport> write(ltm::Recall& recall, const ltm::Query& query,
                                           const std::filesystem::path& path,
                                           const WritingOptions& options,
                                           const ProgressSink& progress,
                                           const std::stop_token& stop) const override {
    return write_episodes(recall, query, path, options, dialect_, progress, stop);
  }

 private:
  const Dialect& dialect_;
};

}  // namespace

std::unique_ptr<const RecordingFormat> make_robomimic_format() {
  return std::make_unique<Hdf5Format>(robomimic_dialect());
}

std::unique_ptr<const RecordingFormat> make_aloha_format() {
  return std::make_unique<Hdf5Format>(aloha_dialect());
}

}  // namespace engram::datasets
