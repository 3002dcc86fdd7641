// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/drivers.h"
#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/facts.h"
#include "datasets/kitchen/kept_commits.h"

namespace engram::datasets::kitchen {

namespace {

using CameraClock = std::chrono::steady_clock;

/// Fewer images than this share of those that are wanted are worth a word.
constexpr double kEnough = 0.9;
constexpr std::chrono::minutes kBetweenWords{1};

ltm::Commit calibrations_of(const BodyDescription& body) {
  ltm::Commit commit;
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const Pose& pose = side == Side::kLeft ? body.pose_head_left : body.pose_head_right;
    add_snapshot(commit, entities::calibration(to_string(side)), body.start,
                 {facts::calibration(side, body.size(), pose)}, "simulation");
  }
  return commit;
}

ltm::Commit views_of(const BodyDescription& body, const BodyPicture& picture) {
  const Time time = body.time_of(picture.sample);
  const facts::Links links{
      {}, entities::joints().at(time).instance(0), entities::platform().at(time).instance(0)};
  std::vector<idf::Data> views;
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const bool is_left = side == Side::kLeft;
    views.push_back(facts::view(is_left ? picture.left : picture.right,
                                is_left ? picture.pose_world_left : picture.pose_world_right,
                                entities::calibration(to_string(side)).at(body.start).instance(0),
                                links));
  }
  ltm::Commit commit;
  add_snapshot(commit, entities::stereo(), time, std::move(views), "camera");
  return commit;
}

}  // namespace

Status drive_camera(RobotBus& bus, const DriverOptions& options, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const BodyDescription body, bus.describe());
  KeptCommits kept(options, calibrations_of(body), body.is_stepped);
  std::map<std::string, double> figures;
  auto told = CameraClock::now();
  auto said = told - kBetweenWords;
  uint64_t committed = 0;
  double images_before = 0;
  double skipped_before = 0;
  // A driver that died has drawn what it was asked for last, or nobody ever will.
  for (uint64_t next = body.begin; !stop.stop_requested();) {
    const auto picture = bus.draw(next, committed, stop);
    if (picture.status().code() == StatusCode::kCancelled) break;
    if (!picture.ok()) return picture.status();
    // Images come at multiples of their period; those that passed meanwhile are not drawn, and
    // those that passed before this driver had begun neither.
    figures["skipped"] += static_cast<double>((picture->sample - next) / RobotBus::kImageEvery);
    next = (picture->sample / RobotBus::kImageEvery + 1) * RobotBus::kImageEvery;
    const auto is_kept = kept.commit(views_of(body, *picture), stop);
    if (is_kept.status().code() == StatusCode::kCancelled) break;
    if (!is_kept.ok()) return is_kept.status();
    figures[*is_kept ? "images" : "lost"] += 1;
    if (*is_kept) committed = picture->sample + 1;
    figures["away"] = kept.times_away();
    const auto now = CameraClock::now();
    if (now - told < options.figures_every) continue;
    const double seconds = std::chrono::duration<double>(now - told).count();
    const double images = figures["images"] - images_before;
    const double skipped = figures["skipped"] - skipped_before;
    figures["images_per_s"] = images / seconds;
    options.tell(figures);
    told = now;
    images_before = figures["images"];
    skipped_before = figures["skipped"];
    if (images > kEnough * (images + skipped) || now - said < kBetweenWords) continue;
    said = now;
    options.say(
        fmt::format("{:.1f} stereo images of {} x {} a second; {:.0f} of {:.0f} were not "
                    "drawn in time",
                    images / seconds, body.width, body.height, skipped, images + skipped));
  }
  options.tell(figures);
  return {};
}

}  // namespace engram::datasets::kitchen
