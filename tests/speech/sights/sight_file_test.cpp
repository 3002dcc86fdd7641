// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/sight_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "speech/sights/sight_reading.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::speech {
namespace {

SavedSights example() {
  SavedSights sights{
      .words = {.kinds = {"Objects/Classes/kitchen/tea_box", "Objects/Classes/kitchen/salt_box"},
                .where = {"", "Objects/Surfaces/kitchen/table", "left"},
                .colours = {"red", "blue"}},
      .model = 0xF00DF00DF00DF00D,
      .grid = {.channels = 5, .rows = 4, .columns = 6},
      .min_probability = 0.4,
      .images = 12};
  torch::manual_seed(3);
  sights.layers = SightLayers(sights.shape());
  sights.layers->fit_normaliser(torch::randn({7, 5, 4, 6}) * 3 + 1);
  sights.layers->eval();
  return sights;
}

TEST(SightFile, ReadsWhatWasSaved) {
  const ScratchDirectory directory;
  const std::filesystem::path file = directory / "kitchen.sights";
  SavedSights saved = example();
  ASSERT_OK(save_sights(saved, file));
  auto read = read_sights(file);
  ASSERT_OK(read);
  EXPECT_EQ(read->words, saved.words);
  EXPECT_EQ(read->model, saved.model);
  EXPECT_EQ(read->grid, saved.grid);
  EXPECT_EQ(read->min_probability, saved.min_probability);
  EXPECT_EQ(read->images, 12);
  const torch::Tensor cells = torch::randn({3, 5, 4, 6});
  const SeenKinds before = read_kinds(saved.layers, cells);
  const SeenKinds after = read_kinds(read->layers, cells);
  EXPECT_TRUE(torch::equal(before.sight, after.sight));
  EXPECT_TRUE(torch::equal(before.places, after.places));
  EXPECT_TRUE(torch::equal(before.colours, after.colours));
  EXPECT_EQ(before.places.sizes(), (std::vector<int64_t>{3, 2, 3}));
  EXPECT_TRUE(torch::allclose(before.places.sum(2), torch::ones({3, 2}), 1e-3, 1e-3));
}

TEST(SightFile, TellsWhatIsWrongWithAFile) {
  const ScratchDirectory directory;
  const std::filesystem::path file = directory / "kitchen.sights";
  EXPECT_FALSE(read_sights(file).ok());
  ASSERT_OK(save_sights(example(), file));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_FALSE(read_sights(file).ok());
  SavedSights other = example();
  other.words.colours.emplace_back("green");  // The layers have two colours.
  ASSERT_OK(save_sights(other, file));
  EXPECT_FAILS(read_sights(file), StatusCode::kDataLoss, "weights");
}

}  // namespace
}  // namespace engram::speech
