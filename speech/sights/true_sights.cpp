// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/true_sights.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "ltm/idf/type.h"
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

const idf::Data* member(const idf::Data& value, std::string_view name) {
  const auto* dict = value.get_if<idf::Dict>();
  return dict == nullptr ? nullptr : dict->find(name);
}

std::string text_of(const idf::Data& value, std::string_view name) {
  const idf::Data* found = member(value, name);
  const auto* text = found == nullptr ? nullptr : found->get_if<std::string>();
  return text == nullptr ? std::string() : *text;
}

std::vector<double> numbers_of(const idf::Data* value, size_t count) {
  const auto* array = value == nullptr ? nullptr : value->get_if<idf::NdArray>();
  if (array == nullptr || array->count() != static_cast<int64_t>(count) ||
      array->type() != idf::ElementType::kFloat64)
    return {};
  const auto numbers = array->values<double>();
  if (!std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); }))
    return {};
  return {numbers.begin(), numbers.end()};
}

/// The first member that is called so and is a pose.
std::optional<Pose> pose_in(const idf::Data& value, std::string_view prefix) {
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return {};
  for (const idf::DictEntry& entry : *dict) {
    if (!entry.key.starts_with(prefix)) continue;
    const auto at = numbers_of(member(entry.value, idf::kPositionKey), 3);
    const auto turn = numbers_of(member(entry.value, idf::kOrientationKey), 4);
    if (at.empty() || turn.empty()) continue;
    Pose pose = Pose::Identity();
    pose.linear() =
        Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).normalized().toRotationMatrix();
    pose.translation() = Eigen::Vector3d(at[0], at[1], at[2]);
    return pose;
  }
  return {};
}

/// A camera without distortion, in cells of an image instead of pixels.
struct Pinhole {
  double focal_x = 0, focal_y = 0, centre_x = 0, centre_y = 0;
  double width = 0, height = 0;  ///< In pixels.

  /// Where a point in front of the camera is. Unit: shares of the width and of the height.
  [[nodiscard]] Eigen::Vector2d see(const Eigen::Vector3d& point) const {
    return {(focal_x * point.x() / point.z() + centre_x + 0.5) / width,
            (focal_y * point.y() / point.z() + centre_y + 0.5) / height};
  }
};

std::optional<Pinhole> pinhole_of(const idf::Data& value) {
  Pinhole camera;
  const std::array<std::pair<const char*, double*>, 6> members{{{"fx", &camera.focal_x},
                                                                {"fy", &camera.focal_y},
                                                                {"cx", &camera.centre_x},
                                                                {"cy", &camera.centre_y},
                                                                {"width", &camera.width},
                                                                {"height", &camera.height}}};
  for (const auto& [name, number] : members) {
    const idf::Data* found = member(value, name);
    const auto told = found == nullptr ? std::nullopt : found->as_number();
    if (!told || !std::isfinite(*told)) return {};
    *number = *told;
  }
  if (camera.width < 1 || camera.height < 1) return {};
  return camera;
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

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Where a camera sees a thing.
TrueSight seen_by(const Pinhole& camera, const Pose& pose_camera_world, const Thing& thing,
                  const ThingMoment& at) {
  TrueSight sight{.kind = thing.kind, .where = at.where, .colour = at.colour};
  const Eigen::Vector3d middle = pose_camera_world * at.pose.translation();
  sight.distance_m = middle.norm();
  if (middle.z() < kMinAhead_m) return sight;
  const Eigen::Vector2d seen = camera.see(middle);
  const bool is_inside = seen.x() >= 0 && seen.x() < 1 && seen.y() >= 0 && seen.y() < 1;
  // Something is before it.
  if (is_inside && !at.is_visible) return sight;
  std::vector<Eigen::Vector2d> corners;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                               (corner & 4) != 0 ? 0.5 : -0.5);
    const Eigen::Vector3d point = pose_camera_world * (at.pose * sign.cwiseProduct(thing.size_m));
    if (point.z() < kMinAhead_m) return sight;
    corners.push_back(camera.see(point));
  }
  sight.outline = hull_of(std::move(corners));
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

  void paint(const std::vector<Eigen::Vector2d>& outline, int64_t kind) {
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column)
        if (is_within(outline, {(column + 0.5) / columns_, (row + 0.5) / rows_}))
          at(row, column) = kind;
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

std::vector<Eigen::Vector2d> hull_of(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
  });
  std::vector<Eigen::Vector2d> hull;  // By monotone chain.
  const auto add_half = [&hull](const auto& begin, const auto& end) {
    const size_t first = hull.size();
    for (auto point = begin; point != end; ++point) {
      while (hull.size() >= first + 2 && cross(hull[hull.size() - 2], hull.back(), *point) <= 0)
        hull.pop_back();
      hull.push_back(*point);
    }
    hull.pop_back();
  };
  add_half(points.begin(), points.end());
  add_half(points.rbegin(), points.rend());
  return hull;
}

bool is_within(const std::vector<Eigen::Vector2d>& hull, const Eigen::Vector2d& point) {
  for (size_t i = 0; i < hull.size(); ++i)
    if (cross(hull[i], hull[(i + 1) % hull.size()], point) < 0) return false;
  return hull.size() >= 3;
}

struct TrueSights::State {
  Memory* memory = nullptr;
  std::unique_ptr<KnownFacts> facts;
  std::vector<Thing> things;
  std::map<std::string, std::optional<Pinhole>> cameras;  ///< By the ID that images link to.

  [[nodiscard]] std::optional<ThingMoment> moment_of(Time time, const idf::Data& value,
                                                     SightWords& words) const;
  Status read_thing(const ltm::MemoryId& entity, SightWords& words,
                    std::map<std::string, Eigen::Vector3d>& sizes);
  Result<Eigen::Vector3d> size_of(const std::string& kind);
  Result<std::optional<Pinhole>> camera(const idf::Data& value);
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
  const idf::Data* visible = member(value, "is_visible");
  const auto* is_visible = visible == nullptr ? nullptr : visible->get_if<bool>();
  moment.is_visible = is_visible != nullptr && *is_visible;
  const std::string hand = text_of(value, "held_by");
  const Eigen::Vector3d at = pose->translation();
  const KnownPlace* place = facts->world().under({.x = at.x(), .y = at.y(), .z = at.z()});
  std::string where = words_of_hand(hand);
  if (hand.empty() && place != nullptr) where = place->entity.to_string();
  moment.where = static_cast<int64_t>(place_among(words.where, where));
  if (const std::string colour = text_of(value, "colour"); !colour.empty())
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
        const auto of_kind = ltm::MemoryId::parse(text_of(value, "object_class"));
        if (of_kind.ok()) kind = of_kind->entity().to_string();
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
        if (const auto size = numbers_of(member(instance.data, "size"), 3); !size.empty())
          return Eigen::Vector3d(size[0], size[1], size[2]);
  return Eigen::Vector3d::Zero().eval();
}

Result<std::optional<Pinhole>> TrueSights::State::camera(const idf::Data& value) {
  const std::string link = text_of(value, "calibration");
  const auto known = cameras.find(link);
  if (known != cameras.end()) return known->second;
  std::optional<Pinhole> camera;
  if (const auto id = ltm::MemoryId::parse(link); id.ok()) {
    const auto told = facts->value_at(*id);
    if (!told.ok() && told.status().code() != StatusCode::kNotFound) return told.status();
    if (told.ok()) camera = pinhole_of(*told);
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
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& corner : thing.outline) middle += corner;
    middle /= static_cast<double>(thing.outline.size());
    const int row = std::clamp(static_cast<int>(middle.y() * grid.rows), 0, grid.rows - 1);
    const int column = std::clamp(static_cast<int>(middle.x() * grid.columns), 0, grid.columns - 1);
    int64_t& cell = truth.kinds[static_cast<size_t>(row * grid.columns + column)];
    if (cell < 0) cell = thing.kind;
  }
  return std::optional(std::move(truth));
}

}  // namespace engram::speech
