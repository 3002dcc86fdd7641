// SPDX-License-Identifier: Apache-2.0
#include "learning/codec_measure.h"

#include <algorithm>
#include <span>

#include "datasets/media/video_reader.h"
#include "ltm/codec/group_codec.h"
#include "store/store_measure.h"
#include "training/quality/ssim.h"

namespace engram::experiments {

namespace fs = std::filesystem;

namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(200);

Status append_video(const fs::path& file, const ClipOptions& options, Clip& clip) {
  datasets::VideoReader::Options reading{options.width, options.height, options.crops_square, 1};
  ENGRAM_ASSIGN_OR_RETURN(auto reader, datasets::VideoReader::open(file, reading));
  Duration next{};
  for (size_t i = 0; clip.images.size() < options.max_frames; ++i) {
    ENGRAM_ASSIGN_OR_RETURN(auto frame, reader.next());
    if (!frame) break;
    // Times are rounded, so a frame that is half a millisecond early counts as in time.
    const bool is_due = options.stride > 0 ? i % options.stride == 0
                                           : frame->time + std::chrono::microseconds(500) >= next;
    if (!is_due) continue;
    next += kPeriod;
    clip.images.push_back(std::move(frame->image));
  }
  return {};
}

Status compare(const Clip& clip, size_t first, std::span<const idf::NdArray> decoded,
               CodecFigures& figures) {
  for (size_t i = 0; i < decoded.size(); ++i) {
    const idf::NdArray& recorded = clip.images[first + i];
    ENGRAM_ASSIGN_OR_RETURN(const double mse, training::image_mse(recorded, decoded[i]));
    ENGRAM_ASSIGN_OR_RETURN(const double similarity, training::ssim(recorded, decoded[i]));
    figures.psnr.add(mse);
    figures.ssim += similarity / static_cast<double>(clip.images.size());
    if (first + i == 0) continue;
    ENGRAM_ASSIGN_OR_RETURN(const double moving,
                            training::moving_mse(clip.images[first + i - 1], recorded, decoded[i]));
    figures.moving.add(moving);
  }
  return {};
}

}  // namespace

Result<Clip> read_clip(const fs::path& folder, const ClipOptions& options) {
  Clip clip{options.name, {}};
  ENGRAM_ASSIGN_OR_RETURN(const auto files, files_below(folder, ".mp4"));
  for (const fs::path& file : files)
    if (file.string().find(options.file) != std::string::npos)
      ENGRAM_RETURN_IF_ERROR(append_video(file, options, clip));
  if (clip.images.empty())
    return not_found("folder '{}': found no video '...{}'", folder.string(), options.file);
  return clip;
}

Result<CodecFigures> measure_codec(const Clip& clip, const std::string& codec, size_t group) {
  ENGRAM_ASSIGN_OR_RETURN(const auto coder, ltm::make_group_codec(codec));
  if (group == 0) group = clip.images.size();
  const auto frames = static_cast<double>(clip.images.size());
  CodecFigures figures;
  for (size_t at = 0; at < clip.images.size(); at += group) {
    const auto images =
        std::span(clip.images).subspan(at).first(std::min(group, clip.images.size() - at));
    Stopwatch watch;
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, coder->encode(images));
    figures.encode_ms += 1e3 * watch.restart() / frames;
    ENGRAM_ASSIGN_OR_RETURN(const auto decoded, coder->decode(bytes, images[0].type(),
                                                              images[0].shape(), images.size()));
    figures.decode_ms += 1e3 * watch.restart() / frames;
    figures.bytes_per_frame += static_cast<double>(bytes.size()) / frames;
    ENGRAM_RETURN_IF_ERROR(compare(clip, at, decoded, figures));
  }
  return figures;
}

}  // namespace engram::experiments
