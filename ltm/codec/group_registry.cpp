// SPDX-License-Identifier: Apache-2.0
#include <fmt/ranges.h>

#include <algorithm>

#include "ltm/codec/codec.h"
#include "ltm/codec/group_codec.h"
#include "ltm/codec/video_codec.h"

namespace engram::ltm {

std::span<const std::string_view> group_codec_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const VideoKind& kind : video_kinds()) all.push_back(kind.name);
    return all;
  }();
  return names;
}

std::vector<std::string_view> available_group_codecs() {
  std::vector<std::string_view> names;
  for (const VideoKind& kind : video_kinds())
    if (is_installed(kind)) names.push_back(kind.name);
  return names;
}

Result<bool> means_groups(std::string_view text) {
  ENGRAM_ASSIGN_OR_RETURN(const CodecText parsed, CodecText::parse(text));
  const auto is_named = [&parsed](const VideoKind& kind) { return kind.name == parsed.name(); };
  if (std::ranges::none_of(video_kinds(), is_named)) return false;
  return find_codec(parsed.name()) == nullptr || parsed.has("group");
}

const GroupCodec* find_group_codec(std::string_view name) {
  static const auto codecs = [] {
    std::vector<std::unique_ptr<const GroupCodec>> made;
    for (const VideoKind& kind : video_kinds())
      made.push_back(std::move(make_video_codec(kind, *CodecText::parse(kind.name))).value());
    return made;
  }();
  for (const auto& codec : codecs)
    if (codec->name() == name) return codec.get();
  return nullptr;
}

Result<std::shared_ptr<const GroupCodec>> make_group_codec(std::string_view text) {
  ENGRAM_ASSIGN_OR_RETURN(CodecText parsed, CodecText::parse(text));
  for (const VideoKind& kind : video_kinds()) {
    if (kind.name != parsed.name()) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto codec, make_video_codec(kind, std::move(parsed)));
    if (!is_installed(kind))
      return failed_precondition("group codec '{}' needs the encoder '{}', available are: {}",
                                 kind.name, kind.encoder,
                                 fmt::join(available_group_codecs(), ", "));
    return std::shared_ptr<const GroupCodec>(std::move(codec));
  }
  return invalid_argument("unknown group codec '{}', needs one of: {}", parsed.name(),
                          fmt::join(group_codec_names(), ", "));
}

}  // namespace engram::ltm
