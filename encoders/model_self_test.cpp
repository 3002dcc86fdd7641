// SPDX-License-Identifier: Apache-2.0
#include "encoders/model_self_test.h"

#include <algorithm>
#include <cmath>

#include "encoders/model_vectors.h"
#include "encoders/model_weights.h"

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

Status write_self_test(h5::File& file, DeepModel& model, const idf::Data& example) {
  ENGRAM_ASSIGN_OR_RETURN(const auto latents, model.encode({&example, 1}));
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
