// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/onnx_detector.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>

#include "ltm/core/mutex.h"
#include "ltm/redaction/scaled_image.h"

namespace engram::ltm {

namespace {

constexpr int kMinSize = 32;
constexpr int kMaxSize = 2048;
constexpr int kMaxClass = 1'000'000;

/// OpenCV prints what it cannot load, although it throws it, too.
class QuietOpenCv {
 public:
  QuietOpenCv() : before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(before_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel before_;
};

/// The input of the network, and how much larger than the image the image is in it.
struct NetworkInput {
  cv::Mat blob;
  double scale = 1;
};

NetworkInput input_of(const cv::Mat& rgb, int size) {
  NetworkInput input;
  input.scale = static_cast<double>(size) / std::max(rgb.cols, rgb.rows);
  const cv::Size inner(std::max(1, static_cast<int>(rgb.cols * input.scale)),
                       std::max(1, static_cast<int>(rgb.rows * input.scale)));
  cv::Mat whole(size, size, CV_8UC3, cv::Scalar::all(128));
  cv::Mat part = whole(cv::Rect(cv::Point(), inner));
  cv::resize(rgb, part, inner, 0, 0, input.scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  input.blob = cv::dnn::blobFromImage(whole, 1 / 255.0);
  return input;
}

std::string shape_text(const cv::Mat& output) {
  std::string text = "[";
  for (int i = 0; i < output.dims; ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ", ", output.size[i]);
  return text + "]";
}

/// There are more boxes than classes in every YOLO; with the axes exchanged, or with boxes that
/// were sorted out already, there are not.
bool is_yolo(const cv::Mat& output) {
  return output.dims == 3 && output.size[0] == 1 && output.size[1] >= 5 &&
         output.size[1] < output.size[2];
}

bool is_ssd(const cv::Mat& output) {
  return output.dims == 4 && output.size[0] == 1 && output.size[1] == 1 && output.size[3] == 7;
}

/// Rounding may lead beyond 1.
constexpr float kMaxScore = 1.001f;
/// A row of an SSD whose image is below zero ends its boxes.
constexpr float kFirstImage = 0;
/// Boxes in pixels reach farther, those in parts of the input hardly.
constexpr float kMaxPart = 2;

bool is_score(float score) {
  return score >= 0 && score <= kMaxScore;  // No number is neither.
}

/// Whether all centres and sizes of a YOLO lie within 0..1, as parts of the input do.
bool is_in_parts(const cv::Mat& yolo) {
  const std::span numbers(yolo.ptr<float>(), static_cast<size_t>(yolo.size[2]) * 4);
  const float max = *std::ranges::max_element(numbers);
  return max > 0 && max <= kMaxPart;
}

/// What an output says, in pixels of the input.
class NetworkBoxes {
 public:
  NetworkBoxes(const OnnxDetector::Options& options, double scale)
      : options_(options), scale_(scale) {}

  void add_yolo(const cv::Mat& output) {
    const int rows = output.size[1];
    const int count = output.size[2];
    const auto* numbers = output.ptr<float>();
    const auto at = [&](int row, int i) {
      return numbers[static_cast<ptrdiff_t>(row) * count + i];
    };
    for (int i = 0; i < count; ++i) {
      bool is_found = false;
      for (int row = 4; row < rows; ++row) is_found = counts(row - 4, at(row, i)) || is_found;
      if (is_found) add(at(0, i) - at(2, i) / 2, at(1, i) - at(3, i) / 2, at(2, i), at(3, i));
    }
  }

  void add_ssd(const cv::Mat& output) {
    const auto* numbers = output.ptr<float>();
    for (int i = 0; i < output.size[2]; ++i, numbers += 7) {
      if (numbers[0] < kFirstImage) break;
      const bool is_class = numbers[1] >= 0 && numbers[1] < static_cast<float>(kMaxClass);
      if (!is_class) return refuse(fmt::format("a class of {}", numbers[1]));
      if (counts(static_cast<int>(numbers[1]), numbers[2])) {
        const auto size = static_cast<float>(options_.size);
        add(numbers[3] * size, numbers[4] * size, (numbers[5] - numbers[3]) * size,
            (numbers[6] - numbers[4]) * size);
      }
    }
  }

  /// Errors: kUnavailable if any number is none, since what it stands for may be anything.
  [[nodiscard]] Result<std::vector<Box>> take() && {
    if (!wrong_.empty())
      return unavailable("detector 'onnx': '{}' gave {}", options_.file.string(), wrong_);
    return std::move(boxes_);
  }

 private:
  void refuse(std::string what) {
    if (wrong_.empty()) wrong_ = std::move(what);
  }

  /// Looks at the score whatever its class, because one that is no number tells nothing at all.
  [[nodiscard]] bool counts(int of_class, float score) {
    if (!is_score(score)) refuse(fmt::format("a score of {}, needs 0 to 1", score));
    if (!(score >= static_cast<float>(options_.threshold))) return false;
    return options_.classes.empty() ||
           std::ranges::find(options_.classes, of_class) != options_.classes.end();
  }

  void add(double x, double y, double width, double height) {
    const bool is_finite =
        std::isfinite(x) && std::isfinite(y) && std::isfinite(width) && std::isfinite(height);
    if (!is_finite) refuse("a box that is not finite");
    if (boxes_.size() == kMaxBoxes) refuse(fmt::format("more than {} boxes", kMaxBoxes));
    if (wrong_.empty() && width > 0 && height > 0)
      boxes_.push_back({x / scale_, y / scale_, width / scale_, height / scale_});
  }

  const OnnxDetector::Options& options_;
  double scale_;
  std::vector<Box> boxes_;
  std::string wrong_;  ///< What was found that cannot be; empty: nothing.
};

}  // namespace

struct OnnxDetector::State {
  Options options;
  Mutex mutex;
  cv::dnn::Net network ENGRAM_GUARDED_BY(mutex);

  Result<cv::Mat> evaluate(const cv::Mat& blob) ENGRAM_EXCLUDES(mutex) {
    const MutexLock lock(mutex);
    network.setInput(blob);
    const cv::Mat output = network.forward().clone();
    if (output.type() != CV_32F || (!is_yolo(output) && !is_ssd(output)))
      return failed_precondition(
          "detector 'onnx': '{}' has an output of shape {}, needs float32 [1, 4 + classes, N] with "
          "more boxes N than 4 + classes, or [1, 1, N, 7]",
          options.file.string(), shape_text(output));
    return output;
  }

  [[nodiscard]] Result<std::vector<Box>> boxes_of(const cv::Mat& output, double scale) const {
    NetworkBoxes boxes(options, scale);
    is_yolo(output) ? boxes.add_yolo(output) : boxes.add_ssd(output);
    return std::move(boxes).take();
  }

  /// Says what is wrong with the network now, and not at the first image.
  Status check() ENGRAM_EXCLUDES(mutex) {
    const auto outputs = [this] {
      const MutexLock lock(mutex);
      return network.getUnconnectedOutLayers().size();
    }();
    if (outputs != 1)
      return failed_precondition("detector 'onnx': '{}' has {} outputs, needs one",
                                 options.file.string(), outputs);
    const cv::Mat nothing(options.size, options.size, CV_8UC3, cv::Scalar::all(0));
    ENGRAM_ASSIGN_OR_RETURN(const cv::Mat output, evaluate(input_of(nothing, options.size).blob));
    if (is_yolo(output) && is_in_parts(output))
      return failed_precondition(
          "detector 'onnx': '{}' gives boxes in parts of its input, needs pixels of it",
          options.file.string());
    const auto boxes = boxes_of(output, 1);
    return boxes.ok() ? Status() : failed_precondition("{}", boxes.status().message());
  }
};

Status OnnxDetector::Options::validate() const {
  if (file.empty()) return invalid_argument("onnx: needs a file");
  if (!(threshold >= 0 && threshold <= 1))
    return invalid_argument("threshold: found {}, needs 0 to 1", threshold);
  if (size < kMinSize || size > kMaxSize)
    return invalid_argument("size: found {}, needs {} to {}", size, kMinSize, kMaxSize);
  return {};
}

OnnxDetector::OnnxDetector(std::unique_ptr<State> state) : state_(std::move(state)) {}
OnnxDetector::~OnnxDetector() = default;

Result<std::unique_ptr<Detector>> OnnxDetector::create(const Options& options) try {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  std::error_code error;
  if (!std::filesystem::is_regular_file(options.file, error))
    return not_found("detector 'onnx': there is no file '{}'", options.file.string());
  const QuietOpenCv quiet;
  auto state = std::make_unique<State>();
  state->options = options;
  {
    const MutexLock lock(state->mutex);
    state->network = cv::dnn::readNetFromONNX(options.file.string());
  }
  ENGRAM_RETURN_IF_ERROR(state->check());
  return std::unique_ptr<Detector>(new OnnxDetector(std::move(state)));
} catch (const std::exception& error) {
  return failed_precondition("detector 'onnx': '{}' cannot be loaded: {}", options.file.string(),
                             error.what());
}

Result<std::vector<Box>> OnnxDetector::find(const DetectorImage& image) try {
  if (is_too_small(image)) return std::vector<Box>();
  cv::Mat rgb = as_mat(image);
  if (image.channels == 1) cv::cvtColor(rgb, rgb, cv::COLOR_GRAY2RGB);
  const NetworkInput input = input_of(rgb, state_->options.size);
  ENGRAM_ASSIGN_OR_RETURN(const cv::Mat output, state_->evaluate(input.blob));
  return state_->boxes_of(output, input.scale);
} catch (const std::exception& error) {
  return unavailable("detector 'onnx': '{}' failed: {}", state_->options.file.string(),
                     error.what());
}

}  // namespace engram::ltm
