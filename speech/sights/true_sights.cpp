// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/true_sights.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>

#include "ltm/context/read_context.h"
#include "ltm/idf/type.h"
#include "speech/facts/fact_members.h"
#include "speech/facts/known_facts.h"

namespace engram::speech {

namespace {

using Pose = Eigen::Isometry3d;

/// A state of a thing tells of an image that was taken at most so much later.
constexpr Duration kMaxAge = std::chrono::milliseconds(250);
/// Cells are looked at in so many parts along their side.
constexpr int kPaintedParts = 4;
/// So many of their 16 parts are of a thing, or at most one, for a cell to be clear.
constexpr int kMinShown = 4;
constexpr int kMaxHidden = 1;
constexpr double kMinAhead_m = 0.05;

/// The first member that is called so and is a pose.
std::optional<Pose> pose_in(const idf::Data& value, std::string_view prefix) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return {};
  for (const idf::DictEntry& entry : *dict) {
    if (!entry.key.starts_with(prefix)) continue;
    const auto at = numbers_in(entry.value, idf::kPositionKey, 3);
    const auto turn = numbers_in(entry.value, idf::kOrientationKey, 4);
    if (!at || !turn) continue;
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::Quaterniond((*turn)[0], (*turn)[1], (*turn)[2], (*turn)[3])
                        .normalized()
                        .toRotationMatrix();
    pose.translation() = Eigen::Vector3d((*at)[0], (*at)[1], (*at)[2]);
    return pose;
  }
  return {};
}

/// Where a camera has a point before it in its image. Unit: shares of the width and of the height.
cv::Point2f seen_at(const ltm::Intrinsics& camera, const Eigen::Vector3d& point) {
  // The middle of the first pixel is 0.
  const double u = (camera.fx * point.x() / point.z() + camera.cx + 0.5) / camera.width;
  const double v = (camera.fy * point.y() / point.z() + camera.cy + 0.5) / camera.height;
  return {static_cast<float>(u), static_cast<float>(v)};
}

/// How a thing was at one time.
struct ThingMoment {
  Time time{};
  Pose pose;
  bool is_visible = false;
  int64_t where = 0;
  int64_t colour = TrueSight::kUntold;
};

struct Thing {
  int64_t kind = 0;
  Eigen::Vector3d size_m;
  std::vector<ThingMoment> moments;  ///< In the order of time.

  [[nodiscard]] const ThingMoment* at(Time time) const {
    auto next = std::upper_bound(moments.begin(), moments.end(), time,
                                 [](Time t, const ThingMoment& moment) { return t < moment.time; });
    if (next == moments.begin()) return nullptr;
    --next;
    return time - next->time > kMaxAge ? nullptr : &*next;
  }
};

/// Where a camera sees a thing.
TrueSight seen_by(const ltm::Intrinsics& camera, const Pose& pose_camera_world, const Thing& thing,
                  const ThingMoment& at) {
  TrueSight sight{.kind = thing.kind, .where = at.where, .colour = at.colour};
  const Eigen::Vector3d middle = pose_camera_world * at.pose.translation();
  sight.distance_m = middle.norm();
  if (middle.z() < kMinAhead_m) return sight;
  const cv::Point2f seen = seen_at(camera, middle);
  const bool is_inside = seen.x >= 0 && seen.x < 1 && seen.y >= 0 && seen.y < 1;
  // Something is before it.
  if (is_inside && !at.is_visible) return sight;
  std::vector<cv::Point2f> corners;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                               (corner & 4) != 0 ? 0.5 : -0.5);
    const Eigen::Vector3d point = pose_camera_world * (at.pose * sign.cwiseProduct(thing.size_m));
    if (point.z() < kMinAhead_m) return sight;
    corners.push_back(seen_at(camera, point));
  }
  cv::convexHull(corners, sight.outline);
  sight.is_in_sight = is_inside;
  return sight;
}

/// The parts of cells of an image, painted from far to near.
class PaintedParts {
 public:
  explicit PaintedParts(const CellGrid& grid)
      : rows_(grid.rows * kPaintedParts),
        columns_(grid.columns * kPaintedParts),
        kinds_(static_cast<size_t>(rows_) * columns_, ImageTruth::kNothing) {}

  void paint(const std::vector<cv::Point2f>& outline, int64_t kind) {
    const cv::Mat shown = mask_of(outline, {columns_, rows_});
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column)
        if (shown.at<uint8_t>(row, column) != 0) at(row, column) = kind;
  }

  /// The kind of a cell, from those of its parts.
  [[nodiscard]] int64_t cell(int row, int column) {
    std::map<int64_t, int> parts;
    for (int y = 0; y < kPaintedParts; ++y)
      for (int x = 0; x < kPaintedParts; ++x)
        ++parts[at(row * kPaintedParts + y, column * kPaintedParts + x)];
    int64_t best = ImageTruth::kUnclear;
    int max_count = kMinShown - 1;
    int shown = 0;
    for (const auto& [kind, count] : parts) {
      if (kind == ImageTruth::kNothing) continue;
      shown += count;
      if (count > max_count) {
        best = kind;
        max_count = count;
      }
    }
    if (best != ImageTruth::kUnclear) return best;
    return shown > kMaxHidden ? ImageTruth::kUnclear : ImageTruth::kNothing;
  }

 private:
  int64_t& at(int row, int column) { return kinds_[static_cast<size_t>(row) * columns_ + column]; }

  int rows_, columns_;
  std::vector<int64_t> kinds_;
};

}  // namespace

cv::Mat mask_of(const std::vector<cv::Point2f>& outline, const cv::Size& size) {
  cv::Mat mask(size, CV_8UC1, cv::Scalar(0));
  if (outline.size() < 3) return mask;
  std::vector<cv::Point2f> in_pixels;
  for (const cv::Point2f& corner : outline)
    in_pixels.emplace_back(corner.x * static_cast<float>(size.width),
                           corner.y * static_cast<float>(size.height));
  // cv::fillConvexPoly counts the edge, too, which is much of a small thing.
  const cv::Rect box = cv::boundingRect(in_pixels) & cv::Rect({0, 0}, size);
  for (int y = box.y; y < box.br().y; ++y)
    for (int x = box.x; x < box.br().x; ++x) {
      const cv::Point2f middle(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
      if (cv::pointPolygonTest(in_pixels, middle, false) >= 0) mask.at<uint8_t>(y, x) = 255;
    }
  return mask;
}

struct TrueSights::State {
  Memory* memory = nullptr;
  std::unique_ptr<KnownFacts> facts;
  std::vector<Thing> things;
  std::map<std::string, std::optional<ltm::Intrinsics>>
      cameras;  ///< By the ID that images link to.

  [[nodiscard]] std::optional<ThingMoment> moment_of(Time time, const idf::Data& value,
                                                     SightWords& words) const;
  Status read_thing(const ltm::MemoryId& entity, SightWords& words,
                    std::map<std::string, Eigen::Vector3d>& sizes);
  Result<Eigen::Vector3d> size_of(const std::string& kind);
  Result<std::optional<ltm::Intrinsics>> camera(const idf::Data& value);
};

TrueSights::TrueSights(std::unique_ptr<State> state) : state_(std::move(state)) {}
TrueSights::TrueSights(TrueSights&&) noexcept = default;
TrueSights::~TrueSights() = default;

/// How a thing was; nothing where its pose is not told.
std::optional<ThingMoment> TrueSights::State::moment_of(Time time, const idf::Data& value,
                                                        SightWords& words) const {
  const auto pose = pose_in(value, "pose_world_");
  if (!pose) return {};
  ThingMoment moment{.time = time, .pose = *pose};
  moment.is_visible = integer_in(value, "is_visible").value_or(0) != 0;
  const std::string hand = text_in(value, "held_by");
  const Eigen::Vector3d at = pose->translation();
  const KnownPlace* place = facts->world().under({.x = at.x(), .y = at.y(), .z = at.z()});
  std::string where = words_of_hand(hand);
  if (hand.empty() && place != nullptr) where = place->entity.to_string();
  moment.where = static_cast<int64_t>(place_among(words.where, where));
  if (const std::string colour = text_in(value, "colour"); !colour.empty())
    moment.colour = static_cast<int64_t>(place_among(words.colours, colour));
  return moment;
}

Status TrueSights::State::read_thing(const ltm::MemoryId& entity, SightWords& words,
                                     std::map<std::string, Eigen::Vector3d>& sizes) {
  Thing thing;
  std::string kind;
  const auto take = [&](const ltm::QueryResult& part) -> Status {
    for (const ltm::EntityResult* found : part.entities())
      for (const ltm::SnapshotResult& snapshot : found->snapshots) {
        if (snapshot.instances.empty()) continue;
        const idf::Data& value = snapshot.instances.front().data;
        auto moment = moment_of(snapshot.time, value, words);
        if (!moment) continue;
        thing.moments.push_back(*std::move(moment));
        if (const auto of_kind = link_in(value, "object_class"))
          kind = of_kind->entity().to_string();
      }
    return {};
  };
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query all, ltm::Query::parse(entity.to_string() + " @ all"));
  ENGRAM_RETURN_IF_ERROR(memory->query_parts(all, take));
  if (kind.empty()) return {};
  if (!sizes.contains(kind)) {
    ENGRAM_ASSIGN_OR_RETURN(sizes[kind], size_of(kind));
  }
  if (sizes[kind].isZero()) return {};
  thing.size_m = sizes[kind];
  thing.kind = static_cast<int64_t>(place_among(words.kinds, kind));
  std::stable_sort(thing.moments.begin(), thing.moments.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  things.push_back(std::move(thing));
  return {};
}

/// Zero where it is not told.
Result<Eigen::Vector3d> TrueSights::State::size_of(const std::string& kind) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query latest, ltm::Query::parse(kind + " @ latest"));
  const auto found = memory->query(latest);
  if (!found.ok()) return Eigen::Vector3d::Zero().eval();
  for (const ltm::EntityResult* entity : found->entities())
    for (const ltm::SnapshotResult& snapshot : entity->snapshots)
      for (const auto& instance : snapshot.instances)
        if (const auto size = numbers_in(instance.data, "size", 3))
          return Eigen::Vector3d((*size)[0], (*size)[1], (*size)[2]);
  return Eigen::Vector3d::Zero().eval();
}

Result<std::optional<ltm::Intrinsics>> TrueSights::State::camera(const idf::Data& value) {
  const std::string link = text_in(value, "calibration");
  const auto known = cameras.find(link);
  if (known != cameras.end()) return known->second;
  std::optional<ltm::Intrinsics> camera;
  if (const auto id = ltm::MemoryId::parse(link); id.ok()) {
    const auto told = facts->value_at(*id);
    if (!told.ok() && told.status().code() != StatusCode::kNotFound) return told.status();
    if (told.ok()) camera = ltm::intrinsics_in(*told);
    if (camera && (camera->width < 1 || camera->height < 1)) camera.reset();
  }
  return cameras[link] = camera;
}

Result<TrueSights> TrueSights::read(Memory& memory, SightWords& words) {
  auto state = std::make_unique<State>();
  state->memory = &memory;
  ENGRAM_ASSIGN_OR_RETURN(state->facts, KnownFacts::read(memory));
  std::map<std::string, Eigen::Vector3d> sizes;
  for (const KnownThing& thing : state->facts->world().things())
    if (thing.entity) ENGRAM_RETURN_IF_ERROR(state->read_thing(*thing.entity, words, sizes));
  if (state->things.empty())
    return not_found("sights: the memory has no things with poses whose kinds have sizes");
  return TrueSights(std::move(state));
}

Result<idf::Data> TrueSights::value_of(const LatentImage& image) {
  return state_->facts->value_at(image.id);
}

Result<std::optional<ImageTruth>> TrueSights::of(const LatentImage& image, const idf::Data& value,
                                                 const CellGrid& grid) {
  const auto pose_world_camera = pose_in(value, "pose_world_");
  ENGRAM_ASSIGN_OR_RETURN(const auto camera, state_->camera(value));
  if (!pose_world_camera || !camera) return std::optional<ImageTruth>();
  const Pose pose_camera_world = pose_world_camera->inverse();
  ImageTruth truth;
  for (const Thing& thing : state_->things)
    if (const ThingMoment* at = thing.at(image.time); at != nullptr)
      truth.things.push_back(seen_by(*camera, pose_camera_world, thing, *at));
  if (truth.things.empty()) return std::optional<ImageTruth>();
  std::sort(truth.things.begin(), truth.things.end(),
            [](const TrueSight& a, const TrueSight& b) { return a.distance_m > b.distance_m; });
  PaintedParts parts(grid);
  for (const TrueSight& thing : truth.things)
    if (!thing.outline.empty()) parts.paint(thing.outline, thing.kind);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      truth.kinds.push_back(parts.cell(row, column));
  // However small a thing is, the cell of its middle is its own where no other is before it.
  for (const TrueSight& thing : truth.things) {
    if (!thing.is_in_sight) continue;
    cv::Point2f middle;
    for (const cv::Point2f& corner : thing.outline) middle += corner;
    middle /= static_cast<float>(thing.outline.size());
    const auto cell_of = [](float share, int count) {
      return std::clamp(static_cast<int>(share * static_cast<float>(count)), 0, count - 1);
    };
    const int row = cell_of(middle.y, grid.rows);
    const int column = cell_of(middle.x, grid.columns);
    int64_t& cell = truth.kinds[static_cast<size_t>(row * grid.columns + column)];
    if (cell < 0) cell = thing.kind;
  }
  return std::optional(std::move(truth));
}

}  // namespace engram::speech
