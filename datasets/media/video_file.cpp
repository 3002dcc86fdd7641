// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/video_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <string_view>
#include <utility>

extern "C" {
#include <libavutil/dict.h>
#include <libavutil/mathematics.h>
}

namespace engram::datasets {

namespace {

constexpr int kNsInSecond = 1'000'000'000;

double to_double(AVRational rate) {
  return rate.den == 0 ? 0.0 : av_q2d(rate);
}

std::optional<Time> creation_time(const AVFormatContext& input, const AVStream& stream) {
  for (const AVDictionary* metadata : {stream.metadata, input.metadata}) {
    const AVDictionaryEntry* entry = av_dict_get(metadata, "creation_time", nullptr, 0);
    if (entry == nullptr) continue;
    if (auto time = parse_time(entry->value); time.ok()) return *time;
  }
  return std::nullopt;
}

uint64_t approximate_frames(const AVFormatContext& input, const AVStream& stream) {
  if (stream.nb_frames > 0) return static_cast<uint64_t>(stream.nb_frames);
  double seconds = 0;
  if (stream.duration > 0)
    seconds = static_cast<double>(stream.duration) * to_double(stream.time_base);
  else if (input.duration > 0)
    seconds = static_cast<double>(input.duration) / AV_TIME_BASE;
  return static_cast<uint64_t>(std::llround(seconds * to_double(stream.avg_frame_rate)));
}

VideoInfo info_of(const AVFormatContext& input, const AVStream& stream) {
  return {.width = stream.codecpar->width,
          .height = stream.codecpar->height,
          .codec = avcodec_get_name(stream.codecpar->codec_id),
          .rate_hz = to_double(stream.avg_frame_rate),
          .approximate_frames = approximate_frames(input, stream),
          .created = creation_time(input, stream)};
}

Announced announced_of(const AVFormatContext& input, AVStream& stream) {
  Announced announced;
  if (stream.nb_frames > 0) announced.packets = static_cast<uint64_t>(stream.nb_frames);
  // An edited MP4 keeps samples that must not be shown; only those to be read are in the index.
  const int entries = avformat_index_get_entries_count(&stream);
  if (std::string_view(input.iformat->name).starts_with("mov") && entries > 0)
    announced.packets = std::min(announced.packets, static_cast<uint64_t>(entries));
  // If there are other streams, the length of the file may be theirs.
  if (input.nb_streams == 1 && input.duration > 0 &&
      input.duration_estimation_method == AVFMT_DURATION_FROM_STREAM)
    announced.length = duration_of(input.duration, AVRational{1, AV_TIME_BASE});
  return announced;
}

Result<libav::Input> open_input(const std::filesystem::path& path) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  if (kind == std::filesystem::file_type::not_found)
    return not_found("video '{}': there is no such file", path.string());
  if (kind != std::filesystem::file_type::regular)
    return invalid_argument("video '{}': needs a file", path.string());
  // "file:" prevents names like "a:b" from being taken for network addresses.
  const std::string url = "file:" + path.string();
  AVFormatContext* opened = nullptr;
  if (const int code = avformat_open_input(&opened, url.c_str(), nullptr, nullptr); code < 0) {
    if (code == AVERROR(EACCES) || code == AVERROR(EMFILE))
      return unavailable("video '{}': cannot open: {}", path.string(), libav::describe(code));
    return invalid_argument("video '{}': is no video, or its index is missing: {}", path.string(),
                            libav::describe(code));
  }
  libav::Input input(opened);
  if (const int code = avformat_find_stream_info(opened, nullptr); code < 0)
    return invalid_argument("video '{}': cannot tell what it holds: {}", path.string(),
                            libav::describe(code));
  return input;
}

/// Finds the stream that plays, and not the cover of a song or a text that FFmpeg would render.
Result<AVStream*> find_video(AVFormatContext& input, const std::filesystem::path& path) {
  const int index = av_find_best_stream(&input, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  AVStream* stream = index < 0 ? nullptr : input.streams[index];
  if (stream == nullptr || (stream->disposition & AV_DISPOSITION_ATTACHED_PIC) != 0 ||
      stream->codecpar->codec_id == AV_CODEC_ID_ANSI)
    return invalid_argument("video '{}': found {} streams, needs a video stream", path.string(),
                            input.nb_streams);
  const AVCodecParameters& stated = *stream->codecpar;
  if (stated.width <= 0 || stated.height <= 0 || stated.width > kMaxVideoSide ||
      stated.height > kMaxVideoSide)
    return invalid_argument("video '{}': size {} x {}, needs 1 to {} pixels", path.string(),
                            stated.width, stated.height, kMaxVideoSide);
  return stream;
}

Result<libav::Codec> open_decoder(const AVStream& stream, int threads,
                                  const std::filesystem::path& path) {
  const char* name = avcodec_get_name(stream.codecpar->codec_id);
  const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
  if (codec == nullptr)
    return invalid_argument("video '{}': no decoder for codec '{}' is installed", path.string(),
                            name);
  libav::Codec decoder(avcodec_alloc_context3(codec));
  if (!decoder || avcodec_parameters_to_context(decoder.get(), stream.codecpar) < 0)
    return resource_exhausted("video '{}': no memory for a decoder", path.string());
  decoder->thread_count = threads;
  decoder->pkt_timebase = stream.time_base;
  // Without this flag, some decoders silently leave out damaged frames.
  decoder->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
  if (const int code = avcodec_open2(decoder.get(), codec, nullptr); code < 0)
    return invalid_argument("video '{}': cannot decode codec '{}': {}", path.string(), name,
                            libav::describe(code));
  return decoder;
}

}  // namespace

Result<VideoFile> open_video_file(const std::filesystem::path& path, int threads) {
  ENGRAM_ASSIGN_OR_RETURN(libav::Input input, open_input(path));
  ENGRAM_ASSIGN_OR_RETURN(AVStream* const stream, find_video(*input, path));
  ENGRAM_ASSIGN_OR_RETURN(libav::Codec decoder, open_decoder(*stream, threads, path));
  for (unsigned i = 0; i < input->nb_streams; ++i)
    if (input->streams[i] != stream) input->streams[i]->discard = AVDISCARD_ALL;
  VideoInfo info = info_of(*input, *stream);
  const Announced announced = announced_of(*input, *stream);
  return VideoFile{std::move(input), stream, std::move(decoder), std::move(info), announced};
}

Duration duration_of(int64_t ticks, AVRational time_base) {
  return Duration(av_rescale_q(ticks, time_base, AVRational{1, kNsInSecond}));
}

}  // namespace engram::datasets
