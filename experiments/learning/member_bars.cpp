// SPDX-License-Identifier: Apache-2.0
// Measures how well members of values are predicted. The snapshots of a store come one by one, and
// every engine and the choice among them predict the next ones. Moments at which the member moves
// are counted separately from those at rest.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "ltm/idf/element_visit.h"
#include "ltm/idf/layout.h"
#include "ltm/prediction/entity_predictor.h"
#include "ltm/prediction/series_engine.h"
#include "ltm/recall/recall.h"
#include "store/report.h"

namespace engram::experiments {
namespace {

struct Arguments {
  std::filesystem::path db;
  std::string entities = "Object/**";
  std::string member = "position";
  std::vector<double> horizons_s{0.2, 0.4, 1.0};
  double moving = 0.001;
  size_t every = 5;
  size_t first = 100;
  std::string json;
};

/// The errors of one engine at one horizon, in the unit of the member.
struct Errors {
  double sum = 0, squares = 0;
  size_t count = 0, told = 0, within = 0;

  void add(double distance, double elements, double bound_mse) {
    sum += distance;
    squares += distance * distance / elements;
    ++count;
    if (std::isnan(bound_mse)) return;
    ++told;
    within += distance * distance / elements <= bound_mse ? 1 : 0;
  }
  [[nodiscard]] double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
  [[nodiscard]] double rmse() const {
    return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
  }
};

/// The first two states are known only in hindsight. The last two are those at the time of the
/// question, as answers state them; bounds are promised for these.
constexpr const char* kStates[] = {"at rest until then", "moving until then", "at rest when asked",
                                   "moving when asked"};

/// Errors by engine, horizon and state.
using AllErrors = std::map<std::string, std::map<double, std::array<Errors, 4>>>;

std::vector<double> elements_of(const idf::Data& value, const std::string& path) {
  const idf::Data* part = path.empty() ? &value : value.at(path);
  if (part == nullptr) return {};
  if (const auto number = part->as_number()) return {*number};
  const auto* array = part->get_if<idf::NdArray>();
  if (array == nullptr) return {};
  return idf::visit_element_type(array->type(), [&]<typename T>(T) {
    const auto values = array->values<T>();
    return std::vector<double>(values.begin(), values.end());
  });
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// Returns the members to measure: the named one, or all numbers below "state/*" and "*".
std::vector<std::string> members_of(const idf::Data& value, const std::string& named) {
  std::vector<std::string> paths;
  const bool is_all = named.ends_with('*');
  const std::string_view front = std::string_view(named).substr(0, named.size() - (is_all ? 1 : 0));
  const idf::Layout layout = idf::Layout::of(value);
  for (const idf::TensorMember& member : layout.members())
    if (member.kind != idf::MemberKind::kBool && member.kind != idf::MemberKind::kImage &&
        (is_all ? member.path.starts_with(front) : member.path == front))
      paths.push_back(member.path);
  return paths;
}

ltm::MemberPrediction told_of(const ltm::SnapshotResult& predicted, const std::string& path) {
  for (const ltm::MemberPrediction& member : predicted.instances.front().members)
    if (member.path == path) return member;
  return {};
}

Status add_entity(ltm::Recall& recall, const ltm::MemoryId& entity, const Arguments& arguments,
                  AllErrors& errors) {
  ENGRAM_ASSIGN_OR_RETURN(const auto answer,
                          recall.query(ltm::Query::of_entity(entity, ltm::select::All{})));
  const std::vector<ltm::SnapshotResult>& all = answer.entities().front()->snapshots;
  ltm::EntityPredictor predictor({entity});
  std::vector<Duration> horizons;
  for (const double seconds : arguments.horizons_s)
    horizons.push_back(std::chrono::round<Duration>(std::chrono::duration<double>(seconds)));
  for (size_t row = 0; row < all.size(); ++row) {
    if (all[row].instances.empty()) continue;
    const idf::Data& now = all[row].instances.front().data;
    ENGRAM_RETURN_IF_ERROR(predictor.add({entity, all[row].time, {{now, {}}}}));
    if (row < arguments.first || row % arguments.every != 0) continue;
    std::vector<std::string> engines{""};
    for (const auto& engine : ltm::make_series_engines()) engines.emplace_back(engine->name());
    for (const std::string& engine : engines) {
      const auto predicted = predictor.predict(horizons, engine);
      if (!predicted.ok()) continue;  // There is nothing to continue.
      for (size_t h = 0; h < horizons.size(); ++h) {
        const auto then = std::ranges::lower_bound(all, (*predicted)[h].time - Duration(1000), {},
                                                   &ltm::SnapshotResult::time);
        if (then == all.end() || then->instances.empty() ||
            then->time - (*predicted)[h].time > horizons[h] / 10)
          continue;
        for (const std::string& path : members_of(now, arguments.member)) {
          const auto is = elements_of(now, path),
                     truth = elements_of(then->instances[0].data, path),
                     found = elements_of((*predicted)[h].instances[0].data, path);
          if (truth.size() != is.size() || found.size() != is.size() || is.empty()) continue;
          const bool is_moving = distance(is, truth) > arguments.moving;
          const ltm::MemberPrediction told = told_of((*predicted)[h], path);
          auto& of_engine = errors[engine.empty() ? "answers" : engine][arguments.horizons_s[h]];
          const double error = distance(found, truth);
          const auto elements = static_cast<double>(is.size());
          of_engine[is_moving ? 1 : 0].add(error, elements, told.bound_mse);
          of_engine[told.is_moving ? 3 : 2].add(error, elements, told.bound_mse);
        }
      }
    }
  }
  return {};
}

void show(const AllErrors& errors, const Arguments& arguments, nlohmann::json& json) {
  for (size_t state = 0; state < std::size(kStates); ++state) {
    fmt::print("{}\n", kStates[state]);
    TextTable table({"engine", "ahead", "predictions", "mean error", "RMSE", "told a bound",
                     "within 90 % bound"});
    for (const double ahead : arguments.horizons_s)
      for (const auto& [engine, by_horizon] : errors) {
        const auto known = by_horizon.find(ahead);
        if (known == by_horizon.end()) continue;
        const Errors& one = known->second[state];
        table.add({engine, fmt::format("{} s", ahead), fmt::format("{}", one.count),
                   fmt::format("{:.5f}", one.mean()), fmt::format("{:.5f}", one.rmse()),
                   fmt::format("{}", one.told),
                   one.told == 0 ? "-"
                                 : fmt::format("{:.1f} %", 100.0 * static_cast<double>(one.within) /
                                                               static_cast<double>(one.told))});
        json[kStates[state]][engine][fmt::format("{}", ahead)] = {{"predictions", one.count},
                                                                  {"mean", one.mean()},
                                                                  {"rmse", one.rmse()},
                                                                  {"told", one.told},
                                                                  {"within", one.within}};
      }
    fmt::print("{}\n", table.to_string());
  }
}

Status run(const Arguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(auto store, ltm::StoreReader::open(arguments.db));
  ltm::Recall recall(std::move(store), {}, nullptr, {});
  ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::parse(arguments.entities));
  AllErrors errors;
  for (const ltm::MemoryId& entity : recall.store().entities())
    if (query.matches(entity))
      ENGRAM_RETURN_IF_ERROR(add_entity(recall, entity, arguments, errors));
  nlohmann::json json;
  show(errors, arguments, json);
  return write_json(arguments.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int count, char** values) {
  using namespace engram::experiments;
  Arguments arguments;
  CLI::App app("Replays a store: how well members of its values are predicted");
  app.add_option("db", arguments.db, "store")->required();
  app.add_option("--entities", arguments.entities, "which, as a query")->capture_default_str();
  app.add_option("--member", arguments.member, "path of the member; *: every number")
      ->capture_default_str();
  app.add_option("--horizons", arguments.horizons_s, "seconds ahead")->capture_default_str();
  app.add_option("--moving", arguments.moving, "it moves where it changes by more until then")
      ->capture_default_str();
  app.add_option("--every", arguments.every, "asks at each n-th snapshot")->capture_default_str();
  app.add_option("--first", arguments.first, "snapshots before the first question")
      ->capture_default_str();
  app.add_option("--json", arguments.json, "write figures there");
  CLI11_PARSE(app, count, values);
  return exit_code("member_bars", run(arguments));
}
