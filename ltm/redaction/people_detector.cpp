// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/people_detector.h"

#include <opencv2/objdetect.hpp>

#include "ltm/redaction/scaled_image.h"

namespace engram::ltm {

struct PeopleDetector::State {
  cv::HOGDescriptor people;
};

PeopleDetector::PeopleDetector(std::unique_ptr<State> state) : state_(std::move(state)) {}
PeopleDetector::~PeopleDetector() = default;

Result<std::unique_ptr<Detector>> PeopleDetector::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  auto state = std::make_unique<State>();
  state->people.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
  return std::unique_ptr<Detector>(new PeopleDetector(std::move(state)));
}

Result<std::vector<Box>> PeopleDetector::find(const DetectorImage& image) try {
  if (is_too_small(image)) return std::vector<Box>();
  const ScaledImage scaled = scaled_grey(image);
  const cv::HOGDescriptor& people = state_->people;
  // Its window is 64 x 128 pixels; it fails on an image that is smaller.
  if (scaled.grey.cols < people.winSize.width || scaled.grey.rows < people.winSize.height)
    return std::vector<Box>();
  std::vector<cv::Rect> found;
  people.detectMultiScale(scaled.grey, found, 0, cv::Size(8, 8), cv::Size(16, 16), 1.05, 1.0);
  return unscaled(found, scaled.scale);
} catch (const cv::Exception& error) {
  return unavailable("detector 'people': {}", error.what());
}

}  // namespace engram::ltm
