// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ltm/core/config.h"
#include "server/navigation/cost_map.h"

namespace engram::navigation {

/// Where things that stand on the floor are in a memory, and which of their members say what.
struct ObstacleSource {
  /// A pattern of entities, as in queries.
  std::string names = "Objects/Instances/.*/.*";
  /// A pose that takes coordinates of the thing, whose origin is its middle, to world.
  std::string pose_member = "pose_world_object";
  /// A link to the entity that tells the size of the thing; empty: the thing tells it itself.
  std::string class_member = "object_class";
  /// An array of three numbers along x, y, z. Unit: m.
  std::string size_member = "size";
  /// "cylinder" where its outline is round; a value that has no such member is a box.
  std::string shape_member = "shape";
  /// Empty where nobody holds the thing; what is held moves with its holder and blocks no floor.
  std::string held_member = "held_by";
  /// Furniture that things stand on: the pose is that of the middle of its top, its x axis goes
  /// along `depth_member`, its y axis along `width_member`, and it blocks the floor below.
  bool is_surface = false;
  std::string depth_member = "depth";
  std::string width_member = "width";
};

/// How fast things of a name may move.
struct SpeedRule {
  std::string name;  ///< A pattern of the last name of an entity.
  double max_speed_m_s = 0;
};

/// What a cost map is made of. The defaults are those of the kitchen (docs/kitchen.md).
struct MapRules {
  std::string provider = "navigation";
  std::string map = "floor";
  GridFrame frame;
  CostRules costs;
  std::vector<ObstacleSource> sources = {ObstacleSource{}, surfaces()};
  std::vector<std::string> class_names = {"Objects/Classes/.*/.*"};
  /// Patterns of last names that are never in the way.
  std::vector<std::string> ignored{};
  /// The first one that matches counts; what none matches stays where it is until it is seen
  /// elsewhere.
  std::vector<SpeedRule> speeds = {{"person.*", 1.2}, {"chair.*", 0.5}};
  /// Lower things are driven over.
  double min_height_m = 0.02;
  /// The robot fits below what begins higher.
  double max_height_m = 2;
  /// How long it takes from where a thing is until the robot brakes for it. Moving things are kept
  /// away from by what they may go in that time. Unit: s.
  double reaction_s = 0.24;

  /// Furniture as the kitchen has it.
  static ObstacleSource surfaces();

  /// The entity that the maps are committed to.
  [[nodiscard]] ltm::MemoryId entity() const;

  /// Errors: kInvalidArgument naming what does not fit.
  [[nodiscard]] Status validate() const;

  /// Reads a configuration; what it does not name keeps its default.
  /// Errors: kInvalidArgument with file, line and key; kNotFound and kUnavailable for the file.
  /// Source: docs/navigation.md, "Configuration".
  static Result<MapRules> read(const ConfigValue& value);
  static Result<MapRules> read_file(const std::filesystem::path& path);
};

}  // namespace engram::navigation
