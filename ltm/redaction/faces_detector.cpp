// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/faces_detector.h"

#include <opencv2/objdetect.hpp>

#include "ltm/core/mutex.h"
#include "ltm/redaction/scaled_image.h"

namespace engram::ltm {

namespace {

/// Where Debian's package opencv-data has it.
constexpr const char* kCascade =
    "/usr/share/opencv4/haarcascades/haarcascade_frontalface_default.xml";

}  // namespace

struct FacesDetector::State {
  Mutex mutex;
  cv::CascadeClassifier faces ENGRAM_GUARDED_BY(mutex);
};

FacesDetector::FacesDetector(std::unique_ptr<State> state) : state_(std::move(state)) {}
FacesDetector::~FacesDetector() = default;

Result<std::unique_ptr<Detector>> FacesDetector::create(const Options& options) try {
  const std::filesystem::path file = options.cascade.empty() ? kCascade : options.cascade;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return not_found("detector 'faces': there is no file '{}'{}", file.string(),
                     options.cascade.empty() ? "; Debian's package opencv-data has it" : "");
  auto state = std::make_unique<State>();
  const bool is_loaded = [&] {
    const MutexLock lock(state->mutex);
    return state->faces.load(file.string());
  }();
  if (!is_loaded)
    return invalid_argument("detector 'faces': '{}' holds no cascade of OpenCV", file.string());
  return std::unique_ptr<Detector>(new FacesDetector(std::move(state)));
} catch (const cv::Exception& error) {
  return invalid_argument("detector 'faces': the cascade cannot be loaded: {}", error.what());
}

Result<std::vector<Box>> FacesDetector::find(const DetectorImage& image) try {
  if (is_too_small(image)) return std::vector<Box>();
  const ScaledImage scaled = scaled_grey(image);
  std::vector<cv::Rect> found;
  {
    const MutexLock lock(state_->mutex);
    state_->faces.detectMultiScale(scaled.grey, found, 1.1, 3, 0, cv::Size(24, 24));
  }
  return unscaled(found, scaled.scale);
} catch (const cv::Exception& error) {
  return unavailable("detector 'faces': {}", error.what());
}

}  // namespace engram::ltm
