// SPDX-License-Identifier: Apache-2.0
#include "encoders/model_self_test.h"

#include <algorithm>
#include <cmath>

#include "encoders/model_vectors.h"
#include "encoders/stored_tensors.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

/// Max difference of decoded grey levels between machines.
constexpr double kImageTolerance = 1.0;
/// Max difference of decoded numbers between machines, in standard deviations.
constexpr double kNumberTolerance = 1e-2;

/// The content of a decoded value that the self test compares: every image element and every
/// number.
struct SelfTest {
  std::vector<double> grey_levels;
  std::vector<double> numbers;  ///< In standard deviations.
};

Result<SelfTest> decoded_example(DeepModel& model, std::span<const std::byte> code) {
  constexpr int64_t kMaxPixels = 512;
  torch::NoGradGuard no_grad;
  SelfTest test;
  ENGRAM_ASSIGN_OR_RETURN(const auto chains, model.codec.decode_all(code, 1));
  const Latents latents = model.to_latents(chains.front(), 0);
  for (const Tensor& image : model.autoencoder->decode(latents).images) {
    if (!image.defined()) continue;
    const Tensor flat = image.contiguous().flatten().clamp(0, 255);
    const int64_t stride = std::max<int64_t>(1, flat.numel() / kMaxPixels);
    for (int64_t i = 0; i < flat.numel(); i += stride)
      test.grey_levels.push_back(flat.data_ptr<float>()[i]);
  }
  if (latents.numbers.defined())
    for (const float number : floats_of(latents.numbers)) test.numbers.push_back(number);
  return test;
}

/// Grey levels of a picture with shades and some edges: networks have something to code there, and
/// a video of it takes few bytes.
double made_up_level(int64_t y, int64_t x, int64_t channel) {
  const double shade = 128 + 60 * std::sin(0.05 * static_cast<double>(x + 40 * channel)) *
                                 std::cos(0.04 * static_cast<double>(y));
  const bool is_square = x / 32 % 4 == 1 && y / 32 % 4 == 1;
  return std::clamp(shade + (is_square ? 40 : 0), 0.0, 255.0);
}

idf::NdArray made_up_image(const ImageMember& image, const idf::TensorMember& member) {
  std::vector<double> levels;
  for (int64_t y = 0; y < image.height; ++y)
    for (int64_t x = 0; x < image.width; ++x)
      for (int64_t channel = 0; channel < image.channels; ++channel)
        levels.push_back(made_up_level(y, x, channel));
  if (!image.is_depth)
    return idf::NdArray::take(member.shape, std::vector<uint8_t>(levels.begin(), levels.end()));
  std::vector<uint16_t> depths;
  for (const double level : levels)
    depths.push_back(static_cast<uint16_t>(std::clamp(level / image.scale, 0.0, 65535.0)));
  return idf::NdArray::take(member.shape, std::move(depths));
}

/// A value of the model's layout that is nobody's memory. Numbers are their means.
idf::SplitValue made_up_example(const DeepModel& model) {
  const auto& members = model.plan.layout().members();
  idf::SplitValue example;
  example.tensors.resize(members.size());
  for (const ImageMember& image : model.plan.images())
    example.tensors[image.member] = made_up_image(image, members[image.member]);
  std::vector<double> numbers = model.mean;
  for (double& number : numbers)
    if (!std::isfinite(number)) number = 0;
  if (!numbers.empty()) model.plan.write_numbers(numbers, example.tensors);
  return example;
}

Status check_close(std::span<const float> stored, std::span<const double> found, double tolerance,
                   std::string_view what) {
  if (stored.size() != found.size())
    return data_loss("self test: found {} {}, needs {}", found.size(), what, stored.size());
  for (size_t i = 0; i < found.size(); ++i)
    if (!(std::abs(found[i] - static_cast<double>(stored[i])) <= tolerance))
      return data_loss("self test: decoded {} {} is {}, needs {} within {}", what, i, found[i],
                       stored[i], tolerance);
  return {};
}

}  // namespace

Status write_self_test(h5::File& file, DeepModel& model) {
  std::vector<idf::SplitValue> example;
  example.push_back(made_up_example(model));
  ENGRAM_ASSIGN_OR_RETURN(const auto latents, model.encode(std::move(example)));
  const ltm::Latent& latent = latents.front();
  ENGRAM_ASSIGN_OR_RETURN(const SelfTest test, decoded_example(model, latent.code.bytes()));
  const auto* bytes = reinterpret_cast<const uint8_t*>(latent.code.data());
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/self_test/code",
                                      std::vector<uint8_t>(bytes, bytes + latent.code.size())));
  std::vector<float> grey(test.grey_levels.begin(), test.grey_levels.end());
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/self_test/grey_levels", grey));
  std::vector<float> numbers(test.numbers.begin(), test.numbers.end());
  return write_vector(file, "/self_test/numbers", numbers);
}

Status run_self_test(const h5::File& file, DeepModel& model) {
  ENGRAM_ASSIGN_OR_RETURN(const auto code, read_vector<uint8_t>(file, "/self_test/code"));
  ENGRAM_ASSIGN_OR_RETURN(const SelfTest test,
                          decoded_example(model, std::as_bytes(std::span(code))));
  ENGRAM_ASSIGN_OR_RETURN(const auto grey, read_vector<float>(file, "/self_test/grey_levels"));
  ENGRAM_ASSIGN_OR_RETURN(const auto numbers, read_vector<float>(file, "/self_test/numbers"));
  ENGRAM_RETURN_IF_ERROR(check_close(grey, test.grey_levels, kImageTolerance, "grey level"));
  return check_close(numbers, test.numbers, kNumberTolerance, "number");
}

}  // namespace engram::encoders
