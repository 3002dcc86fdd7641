// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/driver.h"

#include "server/navigation/drive_run.h"
#include "server/navigation/plan_check.h"

namespace engram::navigation {

namespace {

/// Holds a driver while it does something.
class BusyDriver {
 public:
  explicit BusyDriver(std::atomic<bool>& is_busy)
      : is_busy_(is_busy), was_busy_(is_busy.exchange(true)) {}
  BusyDriver(const BusyDriver&) = delete;
  BusyDriver& operator=(const BusyDriver&) = delete;
  ~BusyDriver() {
    if (!was_busy_) is_busy_ = false;
  }

  [[nodiscard]] Status check(const std::string& robot) const {
    if (!was_busy_) return {};
    return failed_precondition(
        "drive: '{}' drives or plans already, needs that to end before something else", robot);
  }

 private:
  std::atomic<bool>& is_busy_;
  const bool was_busy_;
};

}  // namespace

Status Driver::Options::validate() const {
  ENGRAM_RETURN_IF_ERROR(rules.validate());
  ENGRAM_RETURN_IF_ERROR(planner.validate());
  ENGRAM_RETURN_IF_ERROR(limits.validate());
  if (period <= Duration::zero() || time_limit <= Duration::zero())
    return invalid_argument("drive: period {} and time limit {}, needs more than 0",
                            to_string(period), to_string(time_limit));
  if (patience < Duration::zero() || map_patience < Duration::zero())
    return invalid_argument("drive: patience {} and map patience {}, needs at least 0",
                            to_string(patience), to_string(map_patience));
  return {};
}

Result<std::unique_ptr<Driver>> Driver::open(Memory& memory, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(PathPlanner planner, PathPlanner::create(options.planner));
  ENGRAM_ASSIGN_OR_RETURN(DriveLog log, DriveLog::open(memory, options.robot));
  ENGRAM_ASSIGN_OR_RETURN(std::unique_ptr<MapFeed> maps,
                          MapFeed::open(memory, options.rules.entity()));
  return std::unique_ptr<Driver>(
      new Driver(memory, options, std::move(planner), std::move(log), std::move(maps)));
}

Driver::Driver(Memory& memory, const Options& options, PathPlanner planner, DriveLog log,
               std::unique_ptr<MapFeed> maps)
    : memory_(memory),
      options_(options),
      planner_(std::move(planner)),
      log_(std::move(log)),
      maps_(std::move(maps)) {}

Result<DriveOutcome> Driver::drive(const DriveRequest& request, DriveBase& base,
                                   const std::stop_token& stop, const Report& report) {
  const BusyDriver busy(is_busy_);
  // The base belongs to the drive that goes on, so nobody stops it here.
  ENGRAM_RETURN_IF_ERROR(busy.check(options_.robot));
  DriveRun run(*this, request, base, stop, report);
  auto outcome = run.go();
  // Whatever failed, the robot must not go on with its last command.
  if (!outcome.ok()) {
    if (const Status stopped = base.stop(); !stopped.ok())
      return outcome.status().with_context(
          fmt::format("the base did not stop either ({})", stopped.message()));
  }
  return outcome;
}

Result<ltm::MemoryId> Driver::plan(const DriveRequest& request, const PlanarPose& from, Time time) {
  const BusyDriver busy(is_busy_);
  ENGRAM_RETURN_IF_ERROR(busy.check(options_.robot));
  const auto map = maps_->latest();
  if (map == nullptr)
    return failed_precondition("the memory has no cost map '{}'",
                               options_.rules.entity().printable());
  ENGRAM_ASSIGN_OR_RETURN(ChosenPath chosen,
                          choose_path({memory_, options_.rules, *map, from}, planner_, request));
  if (const Status current = check_map(memory_, *map, options_.rules);
      chosen.found.is_found() && !current.ok()) {
    if (current.code() != StatusCode::kFailedPrecondition) return current;
    chosen.found = {};
    chosen.found.reason = "the map is stale: " + current.message();
  }
  return log_.commit_plan(request, chosen.found,
                          {*map, from, chosen.goal, chosen.location, planner_.options().seed},
                          time);
}

}  // namespace engram::navigation
