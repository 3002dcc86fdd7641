// SPDX-License-Identifier: Apache-2.0
// Points of depth images and of arrays that are clouds, for the scene in 3-D.
#include "reports/plain/shown_value.h"
#include "viewer/shown_cloud.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

/// More are neither seen nor drawn quickly; they take 6 MB.
constexpr int64_t kMaxCloudPoints = 500'000;
/// Bounds of a camera's numbers, so that no product of them is infinite. Unit: pixels.
constexpr double kMaxPixels = 1e6;
constexpr double kMinFocal = 1e-3;

bool has_rows_of_points(const idf::NdArray& array) {
  return array.rank() == 2 && array.shape()[0] > 0 && array.shape()[1] >= 3;
}

bool is_depth(const idf::NdArray& array) {
  return array.rank() == 3 && array.shape()[2] == 1 && array.count() > 0 &&
         (array.type() == idf::ElementType::kUInt16 || array.type() == idf::ElementType::kFloat32);
}

Result<DepthCamera> camera_of(const RequestTarget& target) {
  DepthCamera camera;
  ENGRAM_ASSIGN_OR_RETURN(camera.fx, target.number("fx", kMinFocal, kMaxPixels));
  ENGRAM_ASSIGN_OR_RETURN(camera.fy, target.number("fy", kMinFocal, kMaxPixels));
  ENGRAM_ASSIGN_OR_RETURN(camera.cx, target.number("cx", -kMaxPixels, kMaxPixels));
  ENGRAM_ASSIGN_OR_RETURN(camera.cy, target.number("cy", -kMaxPixels, kMaxPixels));
  return camera;
}

}  // namespace

ViewAnswer answer_cloud(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, target.moment("id"));
  const std::string path = target.find("path").value_or("");
  ENGRAM_ASSIGN_OR_RETURN(const int64_t max,
                          target.integer("max", 1, kMaxCloudPoints, kMaxCloudPoints));
  ENGRAM_ASSIGN_OR_RETURN(const auto found,
                          find_one(viewed.memory(), id.entity(), ltm::select::At{*id.time()}));
  if (!found || found->source == ltm::Source::kPredicted)
    return not_found("'{}': there is no such snapshot", id.to_string());
  const ltm::InstanceResult* const instance = found->find(id.index().value_or(0));
  if (instance == nullptr)
    return not_found("'{}': there is no instance {}", id.to_string(), id.index().value_or(0));
  const idf::Data* const part = instance->data.at(path);
  const idf::NdArray* const array = part == nullptr ? nullptr : part->get_if<idf::NdArray>();
  ShownCloud cloud;
  if (array != nullptr && is_depth(*array)) {
    ENGRAM_ASSIGN_OR_RETURN(const DepthCamera camera, camera_of(target));
    ENGRAM_ASSIGN_OR_RETURN(const double unit_m, target.number("unit", 1e-9, 1e9));
    cloud = cloud_of_depth(*array, camera, unit_m, static_cast<size_t>(max));
  } else if (array != nullptr && has_rows_of_points(*array)) {
    cloud = cloud_of_rows(*array, static_cast<size_t>(max));
  } else {
    return not_found("'{}': has no depth image and no rows of points at '{}'", id.to_string(),
                     path);
  }
  HttpResponse response = binary_response(std::as_bytes(std::span(cloud.points)));
  response.headers = {{"X-Engram-Source", std::string(ltm::to_string(found->source))},
                      {"X-Engram-Points", std::to_string(cloud.points.size() / 3)},
                      {"X-Engram-Total", std::to_string(cloud.known)}};
  return response;
}

}  // namespace engram::viewer
