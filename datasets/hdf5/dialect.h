// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: in what the formats differ.

#include <string>
#include <string_view>
#include <vector>

#include "datasets/hdf5/row_value.h"
#include "datasets/recordings/recording_format.h"
#include "ltm/h5/h5.h"

namespace engram::datasets {

/// One episode in a file.
struct EpisodeGroup {
  std::string name;   ///< "demo_0".
  std::string group;  ///< "/data/demo_0"; empty: the whole file.
};

/// Where the rows of an array go.
struct RowPlace {
  std::string memory;
  std::string core;
  std::string name;
  RowRole role = RowRole::kValues;
};

/// Values a second, and whether that was only assumed.
struct Rate {
  double hz = 0;
  bool is_assumed = false;
};

/// How one format lays out episodes in HDF5.
///
/// Threading: immutable, const-parallel.
class Dialect {
 public:
  virtual ~Dialect() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::string_view about() const = 0;
  [[nodiscard]] virtual bool recognises(const h5::File& file) const = 0;

  /// Whether each episode is a file of its own.
  [[nodiscard]] virtual bool has_file_per_episode() const = 0;

  /// Whether images may be JPEG files.
  [[nodiscard]] virtual bool can_compress() const = 0;

  /// In their order. `stem` is the file's name without its ending.
  /// Errors: kInvalidArgument naming what is missing.
  [[nodiscard]] virtual Result<std::vector<EpisodeGroup>> episodes(
      const h5::File& file, const std::string& stem) const = 0;

  [[nodiscard]] virtual Rate rate(const h5::File& file) const = 0;

  /// Where the rows of the array `name` ("obs/agentview_image") go.
  [[nodiscard]] virtual RowPlace place(const std::string& name,
                                       const h5::ArrayInfo& info) const = 0;

  /// Whether an array says something of others and has no rows of its own.
  [[nodiscard]] virtual bool is_description(const std::string& name) const = 0;

  /// What is said of the whole file, kept with the first episode.
  [[nodiscard]] virtual idf::Dict describe_file(const h5::File& file,
                                                ReadingReport& report) const = 0;

  /// The group that an episode is written as; "" for the whole file.
  [[nodiscard]] virtual std::string group_of(const std::string& episode) const = 0;

  /// Name of the array of an entity that no file of this format had. `member` is empty where the
  /// value has one member alone.
  [[nodiscard]] virtual std::string array_name(const ltm::MemoryId& entity,
                                               const std::string& member) const = 0;

  /// Sets those attributes of an episode that the format needs.
  virtual void complete(idf::Dict& attributes, uint64_t rows) const = 0;

  /// Writes what is said of the whole file. `description`: of describe_file, or empty. `rows`: of
  /// all its episodes.
  [[nodiscard]] virtual Status write_description(h5::File& file, const idf::Dict& description,
                                                 uint64_t rows) const = 0;
};

const Dialect& robomimic_dialect();
const Dialect& aloha_dialect();

/// Whether a name is what is felt of the own body: joints, hands, their poses and forces.
[[nodiscard]] bool is_proprioception(std::string_view name);

/// kImage or kDepth where the shape and name say so, else kValues.
[[nodiscard]] RowRole picture_role(std::string_view name, const h5::ArrayInfo& info);

/// Sets a number, unless it is that already, of whatever type.
void set_number(idf::Dict& attributes, std::string_view name, uint64_t value);

/// The last name of an entity, as part of an array's; depth says that it is depth.
[[nodiscard]] std::string array_stem(const ltm::MemoryId& entity);

/// `text` with '.' for '/'.
[[nodiscard]] std::string dotted(std::string_view text);

}  // namespace engram::datasets
