// SPDX-License-Identifier: Apache-2.0
// Measures the size and quality of video codecs on the clips that learned codecs are measured on.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>

#include "learning/codec_measure.h"
#include "store/report.h"
#include "training/quality/bd_rate.h"

namespace engram::experiments {
namespace {

struct Arguments {
  std::filesystem::path folder;
  std::vector<std::string> clips{"bottle", "one", "g1"};
  std::vector<std::string> codecs{"h264", "h265", "av1"};
  std::vector<int> groups{0, 10};
  std::vector<int> efforts{-1};
  std::vector<int> crfs{20, 26, 32};
  size_t max_frames = 100'000;
  std::string json;
};

const std::map<std::string, ClipOptions> kClips{
    {"bottle", {"bottle", "clips/bottle-detection.mp4", true, 0}},
    {"one", {"one", "clips/one-by-one-person-detection.mp4", true, 0}},
    // Five episodes; later ones are not measured here.
    {"g1", {"g1", "cam_high", false, 6, 304}},
};

/// One codec with one effort and group size, at several qualities.
struct Curve {
  std::string codec;
  int effort = -1;
  int group = 0;

  [[nodiscard]] std::string name() const {
    return codec + (effort < 0 ? "" : fmt::format(" effort {}", effort)) +
           (group == 0 ? ", one group" : fmt::format(", groups of {}", group));
  }
  /// The quality of AV1 counts to 63, that of the others to 51.
  [[nodiscard]] std::string with_crf(int crf) const {
    const int value = codec == "av1" ? crf * 63 / 51 : crf;
    return fmt::format("{}:crf={}{}", codec, value,
                       effort < 0 ? "" : fmt::format(",effort={}", effort));
  }
};

void add_row(const std::string& text, const Curve& curve, const CodecFigures& it, TextTable& table,
             nlohmann::json& json) {
  table.add({text, curve.group == 0 ? "all" : std::to_string(curve.group),
             fmt::format("{:.0f}", it.bytes_per_frame),
             fmt::format("{:.3f}", training::bits_per_pixel(it.bytes_per_frame, 128, 128)),
             fmt::format("{:.2f} / {:.2f}", it.psnr.mean_db(), it.psnr.pooled_db()),
             fmt::format("{:.2f} / {:.2f}", it.psnr.minimum_db(), it.psnr.quantile_db(0.05)),
             fmt::format("{:.2f}", it.moving.mean_db()), fmt::format("{:.4f}", it.ssim),
             std::to_string(it.psnr.capped()),
             fmt::format("{:.1f} / {:.2f}", it.encode_ms, it.decode_ms)});
  json.push_back({{"codec", text},
                  {"group", curve.group},
                  {"bytes_per_frame", it.bytes_per_frame},
                  {"psnr_mean_db", it.psnr.mean_db()},
                  {"psnr_pooled_db", it.psnr.pooled_db()},
                  {"psnr_minimum_db", it.psnr.minimum_db()},
                  {"ssim", it.ssim}});
}

void print_bd_rates(const std::vector<std::pair<Curve, std::vector<training::RatePoint>>>& curves) {
  // H.265 in one group is the reference, and rates are compared at equal quality.
  const auto reference = std::ranges::find_if(
      curves, [](const auto& curve) { return curve.first.codec == "h265" && !curve.first.group; });
  if (reference == curves.end()) return;
  for (const auto& [curve, points] : curves) {
    if (&points == &reference->second) continue;
    const auto rate = training::bd_rate(reference->second, points);
    fmt::print("BD-rate of {} against {}: {}\n", curve.name(), reference->first.name(),
               rate.ok() ? fmt::format("{:+.1f} %", 100 * *rate) : rate.status().message());
  }
}

Status measure(const ClipOptions& options, const Arguments& arguments, nlohmann::json& json) {
  ENGRAM_ASSIGN_OR_RETURN(const Clip clip, read_clip(arguments.folder, options));
  fmt::print("\n{}: {} frames of 128 x 128\n\n", clip.name, clip.images.size());
  TextTable table({"codec", "group", "bytes per frame", "bits per pixel", "PSNR mean / pooled",
                   "minimum / 5 %", "moving", "SSIM", "capped", "ms per frame, in / out"});
  std::vector<std::pair<Curve, std::vector<training::RatePoint>>> curves;
  for (const std::string& codec : arguments.codecs)
    for (const int effort : arguments.efforts)
      for (const int group : arguments.groups) {
        const Curve curve{codec, effort, group};
        std::vector<training::RatePoint> points;
        for (const int crf : arguments.crfs) {
          const std::string text = curve.with_crf(crf);
          ENGRAM_ASSIGN_OR_RETURN(const CodecFigures figures,
                                  measure_codec(clip, text, static_cast<size_t>(group)));
          add_row(text, curve, figures, table, json[clip.name]);
          points.push_back({figures.bytes_per_frame, figures.psnr.mean_db()});
        }
        curves.emplace_back(curve, std::move(points));
      }
  fmt::print("{}\n", table.to_string());
  print_bd_rates(curves);
  return {};
}

Status run(const Arguments& arguments) {
  nlohmann::json json;
  for (const std::string& name : arguments.clips) {
    ClipOptions options = kClips.at(name);
    options.max_frames = std::min(options.max_frames, arguments.max_frames);
    ENGRAM_RETURN_IF_ERROR(measure(options, arguments, json));
  }
  return write_json(arguments.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int count, char** values) {
  using namespace engram::experiments;
  Arguments arguments;
  arguments.folder = recordings_folder();
  CLI::App app("What video codecs need for what quality");
  app.add_option("--recordings", arguments.folder, "folder with the clips (ENGRAM_RECORDINGS)");
  app.add_option("--clips", arguments.clips)->check(CLI::IsMember({"bottle", "one", "g1"}));
  app.add_option("--codecs", arguments.codecs, "h264, h265, av1");
  app.add_option("--groups", arguments.groups, "frames per group; 0: all");
  app.add_option("--efforts", arguments.efforts, "0 to 9; -1: the codec's default");
  app.add_option("--crfs", arguments.crfs, "qualities, 0 to 51; scaled to 63 for av1");
  app.add_option("--frames", arguments.max_frames, "most frames of a clip");
  app.add_option("--json", arguments.json, "write figures there");
  CLI11_PARSE(app, count, values);
  return exit_code("codec_bars", run(arguments));
}
