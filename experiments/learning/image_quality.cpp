// SPDX-License-Identifier: Apache-2.0
// PSNR and SSIM of images as Engram counts them, for those who count them another way too.
#include <CLI/CLI.hpp>
#include <fstream>

#include "store/report.h"
#include "training/quality/psnr.h"
#include "training/quality/ssim.h"

namespace engram::experiments {
namespace {

/// All images of a file of plain RGB bytes.
Result<std::vector<idf::NdArray>> read_images(const std::string& file, int64_t width,
                                              int64_t height) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return not_found("file '{}' cannot be read", file);
  std::vector<idf::NdArray> images;
  const auto size = static_cast<size_t>(width * height * 3);
  std::vector<uint8_t> bytes(size);
  while (in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    images.push_back(idf::NdArray::take({height, width, 3}, std::vector<uint8_t>(bytes)));
  if (in.gcount() != 0) return invalid_argument("file '{}' ends within an image", file);
  return images;
}

struct Arguments {
  std::string recorded, other, json;
  int64_t width = 0, height = 0;
};

Status run(const Arguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const auto recorded,
                          read_images(arguments.recorded, arguments.width, arguments.height));
  ENGRAM_ASSIGN_OR_RETURN(const auto other,
                          read_images(arguments.other, arguments.width, arguments.height));
  if (recorded.size() != other.size())
    return invalid_argument("found {} and {} images, needs as many", recorded.size(), other.size());
  nlohmann::json json;
  for (size_t i = 0; i < recorded.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const double mse, training::image_mse(recorded[i], other[i]));
    ENGRAM_ASSIGN_OR_RETURN(const double ssim, training::ssim(recorded[i], other[i]));
    json["psnr_db"].push_back(training::psnr_db(mse));
    json["ssim"].push_back(ssim);
  }
  fmt::print("{} images\n", recorded.size());
  return write_json(arguments.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  using namespace engram::experiments;
  Arguments arguments;
  CLI::App app("PSNR and SSIM of images: files of plain RGB bytes, one image after another");
  app.add_option("recorded", arguments.recorded)->required();
  app.add_option("other", arguments.other)->required();
  app.add_option("--width", arguments.width)->required()->check(CLI::PositiveNumber);
  app.add_option("--height", arguments.height)->required()->check(CLI::PositiveNumber);
  app.add_option("--json", arguments.json, "write figures there")->required();
  CLI11_PARSE(app, argc, argv);
  return exit_code("image_quality", run(arguments));
}
