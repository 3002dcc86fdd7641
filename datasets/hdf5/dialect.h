// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the differences between the formats.

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
  std::string group;  ///< "/data/demo_0"; empty if the whole file is the episode.
};

/// The entity that the rows of an array go to.
struct RowPlace {
  std::string memory;
  std::string core;
  std::string name;
  RowRole role = RowRole::kValues;
};

/// Values per second, and whether the rate was only assumed.
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

  /// Returns true if each episode is a file of its own.
  [[nodiscard]] virtual bool has_file_per_episode() const = 0;

  /// Returns true if images may be JPEG files.
  [[nodiscard]] virtual bool can_compress() const = 0;

  /// Returns the episodes in their order. `stem` is the name of the file without its extension.
  /// Errors: kInvalidArgument naming what is missing.
  [[nodiscard]] virtual Result<std::vector<EpisodeGroup>> episodes(
      const h5::File& file, const std::string& stem) const = 0;

  [[nodiscard]] virtual Rate rate(const h5::File& file) const = 0;

  /// Returns the entity of the array `name` ("obs/agentview_image").
  [[nodiscard]] virtual RowPlace place(const std::string& name,
                                       const h5::ArrayInfo& info) const = 0;

  /// Returns true if an array only describes others and has no rows of its own.
  [[nodiscard]] virtual bool is_description(const std::string& name) const = 0;

  /// Describes the whole file. The description is kept with the first episode.
  [[nodiscard]] virtual idf::Dict describe_file(const h5::File& file,
                                                ReadingReport& report) const = 0;

  /// The group that an episode is written to; "" for the whole file.
  [[nodiscard]] virtual std::string group_of(const std::string& episode) const = 0;

  /// Returns an array name for an entity that was not imported from this format. `member` is empty
  /// if the value has only one member.
  [[nodiscard]] virtual std::string array_name(const ltm::MemoryId& entity,
                                               const std::string& member) const = 0;

  /// Sets the attributes of an episode that the format requires.
  virtual void complete(idf::Dict& attributes, uint64_t rows) const = 0;

  /// Writes the description of the whole file. `description`: as from describe_file, or empty.
  /// `rows`: the number of rows of all its episodes.
  [[nodiscard]] virtual Status write_description(h5::File& file, const idf::Dict& description,
                                                 uint64_t rows) const = 0;
};

const Dialect& robomimic_dialect();
const Dialect& aloha_dialect();

/// Returns true for names of proprioception: joints, hands, their poses and forces.
[[nodiscard]] bool is_proprioception(std::string_view name);

/// Returns kImage or kDepth if shape and name indicate it, else kValues.
[[nodiscard]] RowRole picture_role(std::string_view name, const h5::ArrayInfo& info);

/// Sets a number, unless it has that value already, in any type.
void set_number(idf::Dict& attributes, std::string_view name, uint64_t value);

/// Returns the last name of an entity as a part of an array's name. Depth entities get "depth" in
/// it.
[[nodiscard]] std::string array_stem(const ltm::MemoryId& entity);

/// Returns `text` with '.' in place of '/'.
[[nodiscard]] std::string dotted(std::string_view text);

}  // namespace engram::datasets
