// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <opencv2/core.hpp>

#include "cli/command.h"
#include "memory/memory.h"
#include "server/navigation/known_things.h"
#include "server/navigation/map_file.h"
#include "server/navigation/navigation_types.h"

namespace engram::cli {

namespace {

constexpr const char* kMapFooter =
    R"(A cost map says where the middle of a robot may be: 0 free, 1 to 252 dearer the nearer to an
obstacle, 253 the robot would touch one, 254 an obstacle, 255 unknown. It is an entity of the memory,
Navigation/CostMap/PROVIDER/NAME (docs/navigation.md). Files are those of map_server: YAML, and a PGM
file beside it.

Examples:
  engram map make kitchen.engram                          # from the objects and furniture in it
  engram map make kitchen.engram --config map.yaml --at '2026-01-01 08:00:10'
  engram map export kitchen.engram --out floor.yaml
  engram map export kitchen.engram --out floor.yaml --pixels raw --json
  engram map import robot.engram floor.yaml --map building/ground
  engram query kitchen.engram 'Navigation/CostMap @ latest')";

struct MapArguments {
  std::string store;
  std::string map = "navigation/floor";
  std::string at;
  std::string config;
  std::string pixels = "trinary";
  std::filesystem::path file;
  bool is_json = false;
};

Result<ltm::MemoryId> map_entity(const MapArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId below, ltm::MemoryId::parse(arguments.map));
  if (below.names().size() != 2 || below.time())
    return invalid_argument("--map '{}': needs PROVIDER/NAME", arguments.map);
  return ltm::MemoryId::from_names({"Navigation", "CostMap", below.names()[0], below.names()[1]});
}

Result<std::optional<Time>> map_time(const MapArguments& arguments) {
  if (arguments.at.empty()) return std::optional<Time>();
  ENGRAM_ASSIGN_OR_RETURN(const Time time, parse_time(arguments.at));
  return std::optional<Time>(time);
}

void print_map(const navigation::CostMap& map, const std::string& done, bool is_json) {
  const int obstacles = cv::countNonZero(map.costs == navigation::kLethalCost);
  const int unknown = cv::countNonZero(map.costs == navigation::kUnknownCost);
  const int free = cv::countNonZero(map.costs < navigation::kInscribedCost);
  if (is_json) {
    Json things = Json::array();
    for (const navigation::Obstacle& thing : map.obstacles)
      things.push_back({{"name", thing.name}, {"snapshot", thing.snapshot.to_string()}});
    Json left_out = Json::array();
    for (const navigation::LeftOutThing& thing : map.left_out)
      left_out.push_back({{"snapshot", thing.snapshot.to_string()}, {"reason", thing.reason}});
    print_json({{"map", map.id.to_string()},
                {"rows", map.frame.rows},
                {"columns", map.frame.columns},
                {"resolution_m", map.frame.resolution_m},
                {"free_cells", free},
                {"obstacle_cells", obstacles},
                {"unknown_cells", unknown},
                {"made_of", std::move(things)},
                {"left_out", std::move(left_out)}});
    return;
  }
  print(fmt::format("{}: {} x {} cells of {} m, {} free, {} of obstacles, {} unknown", done,
                    map.frame.rows, map.frame.columns, map.frame.resolution_m, free, obstacles,
                    unknown));
  for (const navigation::LeftOutThing& thing : map.left_out)
    print(fmt::format("left out '{}': {}", thing.snapshot.printable(), thing.reason));
}

Status commit_map(Memory& memory, const navigation::CostMap& map) {
  const ltm::MemoryId entity = map.id.entity();
  ENGRAM_RETURN_IF_ERROR(
      memory.declare(entity.parent().parent(), ::navigation::CostMap::idf_type()));
  ltm::Instance instance{map.to_data(), {}};
  instance.metadata.created = *map.id.time();
  instance.metadata.provider = entity.parent().names().back();
  ENGRAM_RETURN_IF_ERROR(memory.commit({{{entity, *map.id.time(), {std::move(instance)}}}}));
  return memory.close();
}

Status make(const MapArguments& arguments) {
  navigation::MapRules rules;
  if (!arguments.config.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(rules, navigation::MapRules::read_file(arguments.config));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto at, map_time(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, Memory::open(arguments.store));
  ENGRAM_ASSIGN_OR_RETURN(navigation::CostMap map,
                          navigation::map_of_known_things(*memory, rules, at));
  if (!map.id.has_entity())
    return not_found("{}: has no objects and no furniture that a map could be made of",
                     arguments.store);
  map.version = 1;
  ENGRAM_RETURN_IF_ERROR(commit_map(*memory, map));
  print_map(map, fmt::format("Made {}", map.id.printable()), arguments.is_json);
  return {};
}

Status export_map(const MapArguments& arguments, const ltm::MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const auto at, map_time(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const navigation::MapMode mode,
                          navigation::map_mode_from(arguments.pixels));
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, Memory::open(arguments.store, {.is_read_only = true}));
  const ltm::Selector selector =
      at ? ltm::Selector(ltm::select::Before{*at, true}) : ltm::Selector(ltm::select::Latest{});
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found,
                          memory->query(ltm::Query::of_entity(entity, selector)));
  const ltm::EntityResult* maps = found.find_entity(entity);
  if (maps == nullptr || maps->snapshots.empty() || maps->snapshots.back().instances.empty())
    return not_found("{}: has no map '{}' up to {}", arguments.store, entity.printable(),
                     arguments.at.empty() ? "now" : arguments.at);
  const ltm::SnapshotResult& last = maps->snapshots.back();
  ENGRAM_ASSIGN_OR_RETURN(const navigation::CostMap map,
                          navigation::CostMap::from_data(last.instances.front().data,
                                                         entity.at(last.time).instance(0)));
  ENGRAM_RETURN_IF_ERROR(navigation::write_map_file(arguments.file, map, mode));
  print_map(map, fmt::format("Wrote {}", arguments.file.string()), arguments.is_json);
  return {};
}

Status import_map(const MapArguments& arguments, const ltm::MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const auto at, map_time(arguments));
  ENGRAM_ASSIGN_OR_RETURN(navigation::CostMap map, navigation::read_map_file(arguments.file));
  map.version = 1;
  map.id = entity.at(at.value_or(system_now())).instance(0);
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, Memory::open(arguments.store));
  ENGRAM_RETURN_IF_ERROR(commit_map(*memory, map));
  print_map(map, fmt::format("Imported {}", map.id.printable()), arguments.is_json);
  return {};
}

void add_common_options(CLI::App& command, MapArguments& arguments) {
  command.add_option("store", arguments.store, "Store")->required();
  command.add_flag("--json", arguments.is_json, "As JSON");
}

ExitCode run_with_entity(const MapArguments& arguments,
                         Status (*work)(const MapArguments&, const ltm::MemoryId&)) {
  const auto entity = map_entity(arguments);
  if (!entity.ok()) return wrong_usage(entity.status());
  return done_or_failed(work(arguments, *entity));
}

}  // namespace

void add_map_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<MapArguments>();
  CLI::App* command = app.add_subcommand("map", "Cost maps of where a robot may drive");
  command->footer(kMapFooter);
  command->require_subcommand(1);

  CLI::App* made = command->add_subcommand("make", "Make a map from objects and furniture");
  add_common_options(*made, *arguments);
  made->add_option("--config", arguments->config, "Rules as YAML (docs/navigation.md)")
      ->check(CLI::ExistingFile);
  made->add_option("--at", arguments->at, "As it was at this time; without it as it is now")
      ->check(time_text());
  made->callback([arguments, &exit_code] { exit_code = done_or_failed(make(*arguments)); });

  CLI::App* exported = command->add_subcommand("export", "Write a map as YAML and PGM");
  add_common_options(*exported, *arguments);
  exported->add_option("--out", arguments->file, "YAML file; the PGM file goes beside it")
      ->required();
  exported->add_option("--map", arguments->map, "PROVIDER/NAME")->capture_default_str();
  exported->add_option("--at", arguments->at, "The last map up to this time")->check(time_text());
  exported->add_option("--pixels", arguments->pixels, "How costs become pixels")
      ->check(CLI::IsMember({"trinary", "scale", "raw"}))
      ->capture_default_str();
  exported->callback(
      [arguments, &exit_code] { exit_code = run_with_entity(*arguments, &export_map); });

  CLI::App* imported = command->add_subcommand("import", "Read a map from YAML and PGM");
  add_common_options(*imported, *arguments);
  imported->add_option("file", arguments->file, "YAML file")->required();
  imported->add_option("--map", arguments->map, "PROVIDER/NAME")->capture_default_str();
  imported->add_option("--at", arguments->at, "The time of the map; without it now")
      ->check(time_text());
  imported->callback(
      [arguments, &exit_code] { exit_code = run_with_entity(*arguments, &import_map); });
}

}  // namespace engram::cli
