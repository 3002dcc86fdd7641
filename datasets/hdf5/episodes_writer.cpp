// SPDX-License-Identifier: Apache-2.0
#include "datasets/hdf5/episodes_writer.h"

#include <list>

#include "datasets/hdf5/attributes.h"
#include "datasets/hdf5/row_sink.h"
#include "datasets/recordings/merged_snapshots.h"
#include "ltm/core/file.h"

namespace engram::datasets {

namespace {

/// A file or folder with a temporary name until it is complete. If it is never completed, it is
/// removed.
class PartPath {
 public:
  explicit PartPath(const std::filesystem::path& path) : final_(path), part_(path) {
    part_ += ".part";
    remove();
  }
  PartPath(const PartPath&) = delete;
  PartPath& operator=(const PartPath&) = delete;
  ~PartPath() { remove(); }

  [[nodiscard]] const std::filesystem::path& part() const { return part_; }

  Status publish() const {
    std::error_code error;
    std::filesystem::rename(part_, final_, error);
    if (error) return unavailable("'{}': {}", final_.string(), error.message());
    return {};
  }

 private:
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove_all(part_, ignored);
  }

  std::filesystem::path final_;
  std::filesystem::path part_;
};

idf::Dict part_of(const idf::Dict& dict, std::string_view name) {
  const idf::Data* found = dict.find(name);
  return found != nullptr && found->is<idf::Dict>() ? found->get<idf::Dict>() : idf::Dict();
}

class EpisodesWriter {
 public:
  EpisodesWriter(ltm::Recall& recall, const EpisodesPlan& plan, EpisodeCursors cursors,
                 const WritingOptions& options, const Dialect& dialect,
                 const ProgressSink& progress, std::stop_token stop)
      : recall_(recall),
        plan_(plan),
        cursors_(std::move(cursors)),
        options_(options),
        dialect_(dialect),
        progress_(progress),
        stop_(std::move(stop)) {
    for (const EpisodeRows& episode : plan_.episodes)
      for (const uint64_t rows : episode.rows) total_ += rows;
  }

  /// Writes all episodes to one file.
  Status write_file(const std::filesystem::path& path) {
    ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path, h5::Audience::kEverybody));
    uint64_t rows = 0;
    for (const EpisodeRows& episode : plan_.episodes) {
      ENGRAM_RETURN_IF_ERROR(write_episode(file, episode));
      rows += episode.longest;
    }
    const idf::Dict said = part_of(plan_.episodes.front().episode.attributes, "file");
    ENGRAM_RETURN_IF_ERROR(dialect_.write_description(file, said, rows));
    return close(file);
  }

  /// Writes each episode to a file of its own.
  Status write_folder(const std::filesystem::path& folder) {
    ENGRAM_RETURN_IF_ERROR(make_directories(folder));
    for (const EpisodeRows& episode : plan_.episodes)
      ENGRAM_RETURN_IF_ERROR(write_episode_file(folder / (file_name(episode) + ".hdf5"), episode));
    return {};
  }

  [[nodiscard]] const ExportReport& report() const { return report_; }

 private:
  /// Names of episodes come from files that are not trusted, so they must not lead out of the
  /// folder.
  static std::string file_name(const EpisodeRows& episode) {
    const std::string name = dotted(episode.episode.name);
    return name.empty() || name.starts_with('.') ? "episode" + name : name;
  }

  Status write_episode_file(const std::filesystem::path& path, const EpisodeRows& episode) {
    ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path, h5::Audience::kEverybody));
    ENGRAM_RETURN_IF_ERROR(write_episode(file, episode));
    ENGRAM_RETURN_IF_ERROR(dialect_.write_description(file, {}, episode.longest));
    return close(file);
  }

  Status close(h5::File& file) {
    ENGRAM_RETURN_IF_ERROR(file.close());
    ++report_.files;
    std::error_code ignored;
    report_.bytes += std::filesystem::file_size(file.path(), ignored);
    return {};
  }

  Status write_episode(h5::File& file, const EpisodeRows& episode) {
    const std::string group = dialect_.group_of(episode.episode.name);
    image_sizes_.clear();
    if (!group.empty()) ENGRAM_RETURN_IF_ERROR(file.make_group(group));
    for (size_t i = 0; i < plan_.entities.size(); ++i)
      ENGRAM_RETURN_IF_ERROR(write_entity(file, group, episode, i));
    const idf::Dict& said = episode.episode.attributes;
    for (const auto& [name, attributes] : part_of(said, "objects"))
      if (attributes.is<idf::Dict>())
        ENGRAM_RETURN_IF_ERROR(write_object(file, group + "/" + name, attributes.get<idf::Dict>()));
    idf::Dict attributes = part_of(said, "attributes");
    dialect_.complete(attributes, episode.longest);
    if (dialect_.can_compress() &&
        (!image_sizes_.empty() || attributes.find("compress") != nullptr))
      attributes.set("compress", !image_sizes_.empty());
    ENGRAM_RETURN_IF_ERROR(write_image_sizes(file, episode.longest));
    return write_attributes(file, group.empty() ? "/" : group, attributes);
  }

  /// Writes attributes of an object in an episode, and makes a group if there is no such object.
  static Status write_object(h5::File& file, const std::string& path, const idf::Dict& attributes) {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_there, file.exists(path));
    if (!is_there) ENGRAM_RETURN_IF_ERROR(file.make_group(path));
    return write_attributes(file, path, attributes);
  }

  Status write_entity(h5::File& file, const std::string& group, const EpisodeRows& episode,
                      size_t index) {
    const ExportedEntity& exported = plan_.entities[index];
    const uint64_t rows = episode.rows[index];
    std::vector<std::unique_ptr<RowSink>> columns;
    if (rows > 0)
      for (const Column& column : exported.columns) {
        ENGRAM_ASSIGN_OR_RETURN(auto sink,
                                make_sink(file, group + "/" + column.name, column, rows));
        columns.push_back(std::move(sink));
      }
    while (const auto step = cursors_.peek(index, episode.end)) {
      if (rows > 0) ENGRAM_RETURN_IF_ERROR(write_row(columns, exported.entity, *step));
      ENGRAM_RETURN_IF_ERROR(cursors_.advance(index));
    }
    for (const auto& column : columns) ENGRAM_RETURN_IF_ERROR(column->finish());
    return {};
  }

  Result<std::unique_ptr<RowSink>> make_sink(h5::File& file, const std::string& path,
                                             const Column& column, uint64_t rows) {
    if (options_.jpeg_quality <= 0 || !dialect_.can_compress() || !is_image(column))
      return make_column_sink(file, path, column, rows);
    return make_jpeg_sink(file, path, column, options_.jpeg_quality, image_sizes_.emplace_back());
  }

  /// Writes the sizes of compressed images, a row per camera, as ALOHA stores them.
  Status write_image_sizes(h5::File& file, uint64_t rows) {
    if (image_sizes_.empty()) return {};
    const h5::ArrayInfo array{{h5::Kind::kNumber, h5::Type::kFloat32}, {image_sizes_.size(), rows}};
    ENGRAM_RETURN_IF_ERROR(file.create_array("/compress_len", array));
    uint64_t camera = 0;
    for (std::vector<float>& sizes : image_sizes_) {
      sizes.resize(rows);
      ENGRAM_RETURN_IF_ERROR(
          file.write_array_rows("/compress_len", camera++, std::as_bytes(std::span(sizes))));
    }
    return file.finish_array("/compress_len");
  }

  Status write_row(const std::vector<std::unique_ptr<RowSink>>& columns,
                   const ltm::MemoryId& entity, const SnapshotCursor::Step& step) {
    if (stop_.stop_requested())
      return cancelled("export stopped after {} snapshots; nothing was kept", report_.snapshots);
    ENGRAM_ASSIGN_OR_RETURN(const auto found,
                            recalled_snapshot(recall_, entity, step, options_.recall));
    if (!found || found->instances.empty())
      return data_loss("'{}': cannot be recalled", entity.at(step.entry.time).to_string());
    for (const auto& column : columns)
      if (const Status status = column->add(found->instances.front().data); !status.ok())
        return status.with_context(fmt::format("'{}'", entity.at(step.entry.time).to_string()));
    ++report_.snapshots;
    ++report_.instances;
    if (progress_)
      progress_(
          {"export " + entity.to_string(), report_.snapshots, total_, to_string(step.entry.time)});
    return {};
  }

  ltm::Recall& recall_;
  const EpisodesPlan& plan_;
  EpisodeCursors cursors_;
  const WritingOptions& options_;
  const Dialect& dialect_;
  const ProgressSink& progress_;
  std::stop_token stop_;
  ExportReport report_;
  std::list<std::vector<float>> image_sizes_;  ///< A list, because sinks refer to its elements.
  uint64_t total_ = 0;
};

}  // namespace

Result<EpisodesPlan> plan_export(ltm::Recall& recall, const ltm::Query& query,
                                 const WritingOptions& options, const Dialect& dialect) {
  EpisodesPlan plan;
  ENGRAM_ASSIGN_OR_RETURN(plan.entities,
                          exported_columns(recall, query, options.recall, dialect, plan.not_held));
  ENGRAM_ASSIGN_OR_RETURN(plan.episodes,
                          plan_episodes(recall, query, plan.entities, dialect, plan.not_held));
  return plan;
}

Result<ExportReport> write_episodes(ltm::Recall& recall, const ltm::Query& query,
                                    const std::filesystem::path& path,
                                    const WritingOptions& options, const Dialect& dialect,
                                    const ProgressSink& progress, const std::stop_token& stop) {
  if (std::filesystem::exists(path)) return already_exists("'{}' exists", path.string());
  ENGRAM_ASSIGN_OR_RETURN(const EpisodesPlan plan, plan_export(recall, query, options, dialect));
  if (plan.episodes.empty())
    return not_found("store '{}': query '{}' asks for nothing that {} files can hold",
                     recall.store().path().string(), query.to_string(), dialect.name());
  ENGRAM_ASSIGN_OR_RETURN(auto cursors, EpisodeCursors::create(recall, query, plan.entities));
  EpisodesWriter writer(recall, plan, std::move(cursors), options, dialect, progress, stop);
  const PartPath part(path);
  const bool is_folder = dialect.has_file_per_episode() && plan.episodes.size() > 1;
  ENGRAM_RETURN_IF_ERROR(is_folder ? writer.write_folder(part.part())
                                   : writer.write_file(part.part()));
  ENGRAM_RETURN_IF_ERROR(part.publish());
  ExportReport report = writer.report();
  report.not_carried = plan.not_held;
  return report;
}

}  // namespace engram::datasets
