// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "server/navigation/occupancy_grid.h"
#include "server/navigation/pgm.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::navigation {
namespace {

void write_text(const std::filesystem::path& path, const std::string& text) {
  overwrite_file(path, std::as_bytes(std::span(text)));
}

CostMap walled_map() {
  CostMap map;
  map.frame = {5, 7, 0.05, {-1.25, 2, 0.3}};
  map.costs = cv::Mat::zeros(5, 7, CV_8UC1);
  map.costs.row(0).setTo(kLethalCost);
  map.costs.at<uint8_t>(1, 1) = kInscribedCost;
  map.costs.at<uint8_t>(2, 3) = 120;
  return map;
}

TEST(MapFile, KeepsObstaclesFreeAndUnknownCellsAsTrinary) {
  const ScratchDirectory scratch;
  CostMap map = walled_map();
  map.costs.at<uint8_t>(4, 6) = kUnknownCost;
  ASSERT_OK(write_map_file(scratch / "map.yaml", map));
  const auto back = read_map_file(scratch / "map.yaml");
  ASSERT_OK(back);
  EXPECT_EQ(back->frame, map.frame);
  cv::Mat expected = map.costs.clone();
  expected.at<uint8_t>(1, 1) = kFreeCost;
  expected.at<uint8_t>(2, 3) = kFreeCost;
  EXPECT_EQ(cv::countNonZero(back->costs != expected), 0);
}

TEST(MapFile, KeepsEachOccupancyAsScaleAndRaw) {
  const ScratchDirectory scratch;
  CostMap map;
  map.frame = {1, 101, 0.1, {}};
  map.costs.create(1, 101, CV_8UC1);
  for (int i = 0; i <= 100; ++i) map.costs.data[i] = cost_of_occupancy(i);
  for (const MapMode mode : {MapMode::kScale, MapMode::kRaw}) {
    ASSERT_OK(write_map_file(scratch / "map.yaml", map, mode));
    const auto back = read_map_file(scratch / "map.yaml");
    ASSERT_OK(back);
    for (int i = 0; i <= 100; ++i)
      EXPECT_EQ(occupancy_of_cost(back->costs.data[i]), occupancy_of_cost(map.costs.data[i]))
          << to_string(mode) << " " << i;
  }
  map.costs.data[5] = kUnknownCost;
  ASSERT_OK(write_map_file(scratch / "map.yaml", map, MapMode::kRaw));
  EXPECT_EQ(read_map_file(scratch / "map.yaml")->costs.data[5], kUnknownCost);
  EXPECT_FAILS(write_map_file(scratch / "map.yaml", map, MapMode::kScale),
               StatusCode::kInvalidArgument, "mode scale cannot tell");
}

TEST(MapFile, ReadsWhatMapServersWrite) {
  const ScratchDirectory scratch;
  // Row 0 of the picture is on top, so the second row is the first one of the map.
  write_text(scratch / "m.pgm", "P2\n# by hand\n3 2\n255\n0 205 254\n254 254 100\n");
  write_text(scratch / "m.yaml",
             "image: m.pgm\nresolution: 0.05\norigin: [-10, -10.5, 0.0]\nnegate: 0\n"
             "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  const auto map = read_map_file(scratch / "m.yaml");
  ASSERT_OK(map);
  EXPECT_EQ(map->frame.pose_world_map, (PlanarPose{-10, -10.5, 0}));
  EXPECT_EQ(cv::countNonZero(map->costs != (cv::Mat_<uint8_t>(2, 3) << 0, 0, 255, 254, 255, 0)), 0);
  write_text(scratch / "m.yaml",
             "image: m.pgm\nmode: scale\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 1\n"
             "occupied_thresh: 0.9\nfree_thresh: 0.1\n");
  const auto negated = read_map_file(scratch / "m.yaml");
  ASSERT_OK(negated);
  EXPECT_EQ(negated->costs.at<uint8_t>(1, 0), kFreeCost);
  EXPECT_EQ(negated->costs.at<uint8_t>(1, 2), kLethalCost);
  EXPECT_EQ(negated->costs.at<uint8_t>(0, 2), cost_of_occupancy(37));
}

TEST(MapFile, RefusesHostileHeadersWithTheirLine) {
  const ScratchDirectory scratch;
  write_text(scratch / "m.pgm", "P5 1 1 255\nx");
  const auto reading = [&](const std::string& yaml) {
    write_text(scratch / "m.yaml", yaml);
    return read_map_file(scratch / "m.yaml").status();
  };
  const std::string good = "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n";
  EXPECT_OK(reading(good));
  EXPECT_FAILS(reading("resolution: 0.05\norigin: [0, 0, 0]\n"), StatusCode::kInvalidArgument,
               "image");
  EXPECT_FAILS(reading("image: m.pgm\nresolution: .nan\norigin: [0, 0, 0]\n"),
               StatusCode::kInvalidArgument, "m.yaml:2");
  EXPECT_FAILS(reading("image: m.pgm\nresolution: -1\norigin: [0, 0, 0]\n"),
               StatusCode::kInvalidArgument, "resolution of -1");
  EXPECT_FAILS(reading("image: m.pgm\nresolution: 0.05\norigin: [0, 0]\n"),
               StatusCode::kInvalidArgument, "has 2 numbers");
  EXPECT_FAILS(reading(good + "mode: fuzzy\n"), StatusCode::kInvalidArgument,
               "needs trinary, scale or raw");
  EXPECT_FAILS(reading(good + "negate: 2\n"), StatusCode::kInvalidArgument, "needs 0 or 1");
  EXPECT_FAILS(reading(good + "free_thresh: 0.7\noccupied_thresh: 0.3\n"),
               StatusCode::kInvalidArgument, "free_thresh");
  EXPECT_FAILS(reading(good + "walls: many\n"), StatusCode::kInvalidArgument, "walls");
  EXPECT_FAILS(reading("image: none.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n"),
               StatusCode::kNotFound, "none.pgm");
}

TEST(MapFile, RefusesToWriteNamesThatYamlWouldReadOtherwise) {
  const ScratchDirectory scratch;
  for (const char* name : {"a\"b.yaml", "a\\b.yaml", "a\nb.yaml", "a\x7f.yaml"}) {
    EXPECT_FAILS(write_map_file(scratch / name, walled_map()), StatusCode::kInvalidArgument,
                 "quotes, backslashes or control characters");
    EXPECT_FALSE(std::filesystem::exists(scratch / name));
  }
  // All else comes back as it was.
  for (const char* name : {"a: b.yaml", "'a' #b.yaml", "küche [1].yaml"}) {
    ASSERT_OK(write_map_file(scratch / name, walled_map()));
    EXPECT_OK(read_map_file(scratch / name));
  }
}

TEST(MapFile, ReadsContentsAsItReadsFiles) {
  const auto map = parse_map("image: m.pgm\nresolution: 0.05\norigin: [1, 2, 0]\n",
                             "P2 2 1 255\n0 254", "m.yaml");
  ASSERT_OK(map);
  EXPECT_EQ(map->frame, (GridFrame{1, 2, 0.05, {1, 2, 0}}));
  EXPECT_EQ(map->cost_at({1.01, 2.01}), kLethalCost);
  EXPECT_EQ(map->cost_at({1.06, 2.01}), kFreeCost);
  EXPECT_FAILS(parse_map("image: m.pgm\nresolution: 0.05\norigin: [1, 2, 0]\n", "P2 2", "m.yaml"),
               StatusCode::kDataLoss, "m.pgm: its header ends early");
  EXPECT_FAILS(parse_map("image: 3: 4", "", "m.yaml"), StatusCode::kInvalidArgument, "m.yaml:1");
}

TEST(Pgm, RefusesHostilePictures) {
  const auto reading = [](const std::string& bytes) { return parse_pgm(bytes, "m.pgm").status(); };
  EXPECT_OK(reading(std::string("P5 2 1 65535\n\0\1\2\3", 17)));
  EXPECT_FAILS(reading(""), StatusCode::kDataLoss, "P2 or P5");
  EXPECT_FAILS(reading("P6 1 1 255\nxxx"), StatusCode::kDataLoss, "P2 or P5");
  EXPECT_FAILS(reading("P5 12"), StatusCode::kDataLoss, "header ends early");
  EXPECT_FAILS(reading("P5 -3 1 255\nx"), StatusCode::kDataLoss, "header");
  EXPECT_FAILS(reading("P5 0 1 255\nx"), StatusCode::kDataLoss, "0 x 1 pixels");
  EXPECT_FAILS(reading("P5 99999 99999 255\nx"), StatusCode::kDataLoss, "99999 x 99999");
  EXPECT_FAILS(reading("P5 99999999999999999999 1 255\nx"), StatusCode::kDataLoss, "header");
  EXPECT_FAILS(reading("P5 8000 8000 255\nx"), StatusCode::kDataLoss, "need 64000001");
  EXPECT_FAILS(reading("P5 1 1 70000\nxx"), StatusCode::kDataLoss, "largest value");
  EXPECT_FAILS(reading("P5 2 1 100\n\x01\xff"), StatusCode::kDataLoss, "pixel 1 is 255");
  EXPECT_FAILS(reading("P2 2 1 255\n12 abc"), StatusCode::kDataLoss, "pixel 1");
  EXPECT_FAILS(reading("P2 2 1 255\n1 999"), StatusCode::kDataLoss, "pixel 1");
}

}  // namespace
}  // namespace engram::navigation
