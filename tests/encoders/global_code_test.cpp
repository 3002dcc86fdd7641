// SPDX-License-Identifier: Apache-2.0
#include "encoders/global_code.h"

#include <gtest/gtest.h>

#include <cmath>

#include "encoders/deep_model_file.h"
#include "encoders/model_records.h"
#include "tests/training/moving_scene.h"

namespace engram::encoders {
namespace {

using engram::testing::quick_options;
using engram::testing::scene_at;
using engram::testing::scene_source;
using engram::testing::ScratchPath;

double distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(double{a[i]} - double{b[i]}, 2);
  return std::sqrt(sum);
}

/// A model of the moving scene, trained for some steps.
class GlobalCodes : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    file_ = std::make_unique<ScratchPath>("global_code");
    const auto report =
        training::train_model(scene_source(40, 2), quick_options(200), file_->path(), {}, {});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
  }
  static void TearDownTestSuite() { file_.reset(); }

  static std::shared_ptr<DeepModel> load() {
    auto model = read_model(file_->path());
    ENGRAM_CHECK(model.ok(), "{}", model.status().to_string());
    return std::move(model).value();
  }

  static std::unique_ptr<ScratchPath> file_;
};

std::unique_ptr<ScratchPath> GlobalCodes::file_;

TEST_F(GlobalCodes, AreNearWhereImagesLookAlike) {
  const auto model = load();
  const auto code = [&](int i) { return *model->global_code_of(scene_at(i)); };
  ASSERT_EQ(code(3).size(), static_cast<size_t>(kGlobalCodeSize));
  EXPECT_EQ(code(3), code(3));
  // The square moves by two pixels each time, and is back after 18.
  EXPECT_LT(distance(code(4), code(5)), 0.6 * distance(code(4), code(8)));
  EXPECT_LT(distance(code(2), code(20)), 0.6 * distance(code(2), code(6)));
  EXPECT_GT(distance(code(4), code(12)), 1.0);  // Grey levels.
}

TEST_F(GlobalCodes, AreMadeFromStoredLatentsWithoutTheirImages) {
  const auto model = load();
  const std::vector<idf::Data> values{scene_at(4), scene_at(5), scene_at(6)};
  const auto latents = *model->encode(values);
  const auto chains = *model->codec.decode_all(latents[0].code.bytes(), 3);
  const LatentRows& rows = chains.front();
  for (size_t row = 0; row < 3; ++row) {
    const auto code = model->global_code_of(rows, row, latents[row].remainder);
    ASSERT_TRUE(code.ok()) << code.status().to_string();
    EXPECT_LT(distance(*code, *model->global_code_of(values[row])), 1e-3);
  }
}

TEST_F(GlobalCodes, AreMadeFromVideosToo) {
  const auto model = load();
  const idf::Data value = scene_at(4);
  const auto split = *model->plan.layout().split(value);
  LatentRows rows = *model->to_rows({&split, 1});
  const auto from_latents = *model->global_code_of(rows, 0, split.remainder);
  rows.images[0] = {.form = ImageForm::kFfv1,
                    .frames = {split.tensors[model->plan.images()[0].member]}};
  const auto from_frames = model->global_code_of(rows, 0, split.remainder);
  ASSERT_TRUE(from_frames.ok()) << from_frames.status().to_string();
  EXPECT_LT(distance(*from_frames, from_latents), 1e-3);
}

TEST_F(GlobalCodes, AreAskedOfAnEncoder) {
  const auto encoder = make_encoder(load());
  std::vector<idf::Data> values;
  for (int i = 0; i < 20; ++i) values.push_back(scene_at(i));  // Two blocks.
  const auto codes = encoder->global_codes(*encoder->encode(values));
  ASSERT_TRUE(codes.ok()) << codes.status().to_string();
  ASSERT_EQ(codes->size(), 20u);
  for (size_t i = 0; i < values.size(); ++i)
    EXPECT_LT(distance((*codes)[i], *encoder->global_code(values[i])), 1e-3);
}

TEST_F(GlobalCodes, RejectValuesOfAnotherLayout) {
  EXPECT_EQ(load()->global_code_of(idf::Data("text")).status().code(),
            StatusCode::kInvalidArgument);
}

/// An HDF5 file with what `write` puts there, opened.
h5::File reopened(const std::filesystem::path& path,
                  const std::function<Status(h5::File&)>& write) {
  auto file = h5::File::create(path);
  ENGRAM_CHECK(file.ok(), "{}", file.status().to_string());
  ENGRAM_CHECK(write(*file).ok() && file->close().ok(), "cannot write");
  return std::move(h5::File::open(path)).value();
}

TEST_F(GlobalCodes, AreMissingInFilesFromBeforeThereWereAny) {
  const ScratchPath path("global_code_before");
  const auto file = reopened(path.path(), [](h5::File& made) { return made.make_group("/codec"); });
  const auto code = read_global_code(file, load()->autoencoder->shape);
  ASSERT_TRUE(code.ok()) << code.status().to_string();
  EXPECT_FALSE(code->is_known());
}

TEST_F(GlobalCodes, ReadAsTheyWereWrittenOrAreRejected) {
  const ScratchPath path("global_code_alone");
  const auto model = load();
  const auto file = reopened(
      path.path(), [&](h5::File& made) { return write_global_code(made, model->global_code); });
  NetworkShape shape = model->autoencoder->shape;
  const auto code = read_global_code(file, shape);
  ASSERT_TRUE(code.ok()) << code.status().to_string();
  EXPECT_TRUE(torch::equal(code->projection, model->global_code.projection));
  EXPECT_TRUE(torch::equal(code->offset, model->global_code.offset));
  ++shape.sizes.coarse_channels;
  EXPECT_EQ(read_global_code(file, shape).status().code(), StatusCode::kDataLoss);
}

TEST_F(GlobalCodes, AreMissingInModelsWithoutImages) {
  const ScratchPath file("global_code_numbers");
  const auto source = scene_source(24, 1, false, true);
  ASSERT_TRUE(training::train_model(source, quick_options(4), file.path(), {}, {}).ok());
  const auto model = *read_model(file.path());
  EXPECT_EQ(model->global_code_of(scene_at(3, false, true)).status().code(),
            StatusCode::kFailedPrecondition);
}

}  // namespace
}  // namespace engram::encoders
