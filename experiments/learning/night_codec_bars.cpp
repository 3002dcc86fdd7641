// SPDX-License-Identifier: Apache-2.0
// Measures what video encoders need where every image of a chain must keep a bound of PSNR, and how
// much processor time one encode near that bound takes: training/forms/video_effort.h.
#include <CLI/CLI.hpp>

#include <cmath>
#include <map>

#include "learning/codec_measure.h"
#include "learning/video_trial.h"
#include "store/report.h"

namespace engram::experiments {
namespace {

/// A decibel of the worst image is about this many steps of crf.
constexpr double kStepsPerDb = 2.5;
constexpr int kMaxStep = 6;
/// Encodes this near to the result count as encodes near the bound.
constexpr int kNear = 2;

struct Arguments {
  std::filesystem::path folder;
  std::vector<int> sizes{128, 256, 640};
  std::vector<double> bounds{36};
  std::vector<size_t> chains{16};
  /// What the night did before, and then the ladder.
  std::vector<std::string> trials{"av1:effort=7",
                                  "av1:effort=7,depth=10,spread=2",
                                  "av1:effort=6,depth=10,spread=2",
                                  "av1:effort=5,depth=10,spread=2",
                                  "av1:effort=5,spread=2",
                                  "av1:effort=4,spread=2",
                                  "av1:effort=3,spread=2"};
  size_t frames = 32;
  std::string json;
};

/// A clip and how much more is asked of it. A still camera keeps 36 dB at the worst quality, which
/// says nothing.
struct Bar {
  Clip clip;
  double more_db = 0;
};

Result<std::vector<Bar>> read_bars(const Arguments& arguments, int size) {
  const bool is_native = size == 640;
  const int side = is_native ? 0 : size;
  std::vector<Bar> bars;
  const auto add = [&](const char* name, const char* file, bool crops, double more_db) -> Status {
    const ClipOptions options{name, file, crops && !is_native, 6, arguments.frames, side, side};
    ENGRAM_ASSIGN_OR_RETURN(Clip clip, read_clip(arguments.folder, options));
    bars.push_back({std::move(clip), more_db});
    return {};
  };
  ENGRAM_RETURN_IF_ERROR(add("g1 5", "cam_high/episode_000005.mp4", false, 0));
  ENGRAM_RETURN_IF_ERROR(add("g1 11", "cam_high/episode_000011.mp4", false, 0));
  ENGRAM_RETURN_IF_ERROR(add("bottle", "clips/bottle-detection.mp4", true, 6));
  return bars;
}

/// Sums over chains.
struct Sums {
  double images = 0, bytes = 0, bytes_at_bound = 0, spread_db = 0;
  double near_images = 0, encode_seconds = 0, decode_seconds = 0;
  int encodes = 0;
};

/// Searches for the worst quality that keeps the bound, and for the next one, which misses it.
class ChainSearch {
 public:
  ChainSearch(const VideoTrial& trial, std::span<const idf::NdArray> images, double bound_db)
      : trial_(trial), images_(images), bound_db_(bound_db), bad_(trial.max_crf() + 1) {}

  /// Returns the crf that was found, or an error if there is none.
  Result<int> run(int crf) {
    while (bad_ - good_ > 1) {
      crf = std::clamp(crf, good_ + 1, bad_ - 1);
      ENGRAM_ASSIGN_OR_RETURN(TrialResult result, trial_.run(images_, crf));
      const double left_db = result.min_db() - bound_db_;
      (left_db >= 0 ? good_ : bad_) = crf;
      results_.insert_or_assign(crf, std::move(result));
      const auto step = std::lround(std::abs(left_db) * kStepsPerDb);
      const int jump = static_cast<int>(std::clamp<long>(step, 1, kMaxStep));
      crf += left_db >= 0 ? jump : -jump;
    }
    if (good_ < 0) return failed_precondition("no quality keeps {} dB", bound_db_);
    return good_;
  }

  void add_to(Sums& sums) const {
    const auto count = static_cast<double>(images_.size());
    const TrialResult& found = results_.at(good_);
    sums.images += count;
    sums.encodes += static_cast<int>(results_.size());
    sums.bytes += found.bytes;
    sums.bytes_at_bound += bytes_at_bound();
    sums.spread_db += count * (found.mean_db() - found.min_db());
    for (const auto& [crf, result] : results_) {
      if (std::abs(crf - good_) > kNear) continue;
      sums.near_images += count;
      sums.encode_seconds += result.encode_seconds;
      sums.decode_seconds += result.decode_seconds;
    }
  }

 private:
  /// Interpolates between both sides of the bound, so that chance steps of crf do not count.
  [[nodiscard]] double bytes_at_bound() const {
    const TrialResult& good = results_.at(good_);
    if (!results_.contains(bad_)) return good.bytes;
    const TrialResult& bad = results_.at(bad_);
    const double share = (good.min_db() - bound_db_) / (good.min_db() - bad.min_db());
    return good.bytes * std::pow(bad.bytes / good.bytes, share);
  }

  const VideoTrial& trial_;
  std::span<const idf::NdArray> images_;
  double bound_db_;
  int good_ = -1;
  int bad_;
  std::map<int, TrialResult> results_;
};

Result<Sums> measure_clip(const VideoTrial& trial, const Bar& bar, double bound_db, size_t chain) {
  Sums sums;
  const std::span<const idf::NdArray> all = bar.clip.images;
  int crf = trial.max_crf() / 2;
  for (size_t at = 0; at + chain / 2 < all.size(); at += chain) {
    const auto images = all.subspan(at, std::min(chain, all.size() - at));
    ChainSearch search(trial, images, bound_db + bar.more_db);
    ENGRAM_ASSIGN_OR_RETURN(crf, search.run(crf));
    search.add_to(sums);
  }
  return sums;
}

/// Measures one row of the table. Each clip counts the same in `relative`, the geometric mean of
/// its bytes at the bound relative to those of the first trial, which fill `first` where it is
/// empty.
Status measure_trial(const std::string& text, const std::vector<Bar>& bars, double bound_db,
                     size_t chain, std::vector<double>& first, TextTable& table,
                     nlohmann::json& json) {
  ENGRAM_ASSIGN_OR_RETURN(const VideoTrial trial, VideoTrial::create(text));
  const bool is_first = first.empty();
  double relative = 0, bytes = 0, at_bound = 0, spread = 0, encode = 0, decode = 0, encodes = 0;
  for (size_t i = 0; i < bars.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const Sums sums, measure_clip(trial, bars[i], bound_db, chain));
    const double share = 1.0 / static_cast<double>(bars.size());
    const double bytes_here = sums.bytes_at_bound / sums.images;
    if (is_first) first.push_back(bytes_here);
    relative += share * std::log(bytes_here / first[i]);
    bytes += share * sums.bytes / sums.images;
    at_bound += share * bytes_here;
    spread += share * sums.spread_db / sums.images;
    encode += share * sums.encode_seconds / sums.near_images;
    decode += share * sums.decode_seconds / sums.near_images;
    encodes += sums.encodes;
  }
  table.add({text, std::to_string(chain), fmt::format("{:.0f} dB", bound_db),
             fmt::format("{:.0f}", bytes), fmt::format("{:.0f}", at_bound),
             fmt::format("{:+.1f} %", 100 * (std::exp(relative) - 1)),
             fmt::format("{:.2f}", spread), fmt::format("{:.4f}", encode),
             fmt::format("{:.2f}", 1e3 * decode), fmt::format("{:.0f}", encodes)});
  // A run takes long, so each row is shown when it is there.
  fmt::print(stderr, "{}, chains of {}, {:.0f} dB: {:.0f} bytes ({:+.1f} %), {:.4f} s\n", text,
             chain, bound_db, at_bound, 100 * (std::exp(relative) - 1), encode);
  json.push_back({{"trial", text},
                  {"chain", chain},
                  {"bound_db", bound_db},
                  {"bytes", bytes},
                  {"bytes_at_bound", at_bound},
                  {"relative", std::exp(relative)},
                  {"encode_seconds", encode},
                  {"decode_seconds", decode}});
  return {};
}

Status run(const Arguments& arguments) {
  nlohmann::json json;
  for (const int size : arguments.sizes) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bars, read_bars(arguments, size));
    const std::string name = size == 640 ? "640 x 480" : fmt::format("{} x {}", size, size);
    TextTable table({"settings", "chain", "bound", "bytes an image", "at the bound",
                     "against first", "mean - min dB", "s to encode", "ms to decode", "encodes"});
    for (const double bound_db : arguments.bounds) {
      std::vector<double> first;
      for (const size_t chain : arguments.chains)
        for (const std::string& text : arguments.trials) {
          const Status status =
              measure_trial(text, bars, bound_db, chain, first, table, json[name]);
          if (!status.ok()) fmt::print(stderr, "{}: {}\n", text, status.to_string());
        }
    }
    fmt::print("\n{}, images of three clips, processor time per image\n\n{}\n", name,
               table.to_string());
  }
  return write_json(arguments.json, json);
}

}  // namespace
}  // namespace engram::experiments

int main(int count, char** values) {
  using namespace engram::experiments;
  Arguments arguments;
  arguments.folder = recordings_folder();
  CLI::App app("What video encoders need where every image must keep a bound, and how long");
  app.add_option("--recordings", arguments.folder, "folder with the clips (ENGRAM_RECORDINGS)");
  app.add_option("--sizes", arguments.sizes)->check(CLI::IsMember({128, 256, 640}));
  app.add_option("--bounds", arguments.bounds, "least PSNR; 6 dB more for the still camera");
  app.add_option("--chains", arguments.chains, "images per chain");
  app.add_option("--trials", arguments.trials,
                 "codecs or encoders: experiments/learning/video_trial.h")
      ->delimiter(';');
  app.add_option("--frames", arguments.frames, "images of each clip");
  app.add_option("--json", arguments.json, "write figures there");
  CLI11_PARSE(app, count, values);
  return exit_code("night_codec_bars", run(arguments));
}
