// SPDX-License-Identifier: Apache-2.0
#include "augmentation/light.h"

#include <opencv2/core.hpp>

namespace engram::augmentation {

void map_levels(SceneImages& images, const std::function<int64_t(int, int)>& of) {
  cv::Mat table(1, 256, CV_8UC3);
  for (int level = 0; level < 256; ++level)
    for (int channel = 0; channel < 3; ++channel)
      table.at<cv::Vec3b>(level)[channel] = to_grey_level(of(channel, level));
  cv::Mat of_grey;
  cv::extractChannel(table, of_grey, 1);
  for (SceneImage& image : images.images)
    if (image.role == PixelRole::kLight)
      cv::LUT(image.pixels, image.pixels.channels() == 1 ? of_grey : table, image.pixels);
}

}  // namespace engram::augmentation
