// SPDX-License-Identifier: Apache-2.0
#include "training/night/night_history.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "encoders/latent_block.h"
#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/store/checkpoint_file.h"

namespace engram::training {

namespace {

using Json = nlohmann::json;

/// A history has some hundred bytes. A file with more is not ours.
constexpr uint64_t kMaxBytes = uint64_t{1} << 20;

/// A chain of more rows was made by nobody.
constexpr int64_t kMaxChainRows = encoders::kMaxBlockRows;

std::string key_of_search(EntityVideos& videos) {
  const VideoSearchOptions& search = videos.search_of(0).options();
  return fmt::format("{}:{}", search.codec, search.settings);
}

Json json_of(const VideoHistory::Line& line) {
  return {{"slope", line.slope},
          {"at_crf", line.at_crf},
          {"at_db", line.at_db},
          {"bytes_per_db", line.bytes_per_db}};
}

/// Throws what nlohmann::json throws.
NightHistory history_of(const Json& json) {
  NightHistory history;
  history.networks_lost_at = json.at("networks_lost_at").get<uint64_t>();
  for (const auto& [codec, members] : json.at("videos").items())
    for (const Json& line : members)
      history.lines[codec].push_back({line.at("slope").get<double>(),
                                      line.at("at_crf").get<double>(),
                                      line.at("at_db").get<double>(),
                                      line.value("bytes_per_db", VideoHistory::kUsualBytesPerDb)});
  if (const auto chain = json.find("chain"); chain != json.end()) {
    const auto rows = chain->at("rows").get<int64_t>();
    if (rows >= 1 && rows <= kMaxChainRows)
      history.chain = {Duration(chain->at("access_ns").get<int64_t>()), static_cast<int>(rows)};
  }
  return history;
}

}  // namespace

void NightHistory::teach(EntityVideos& videos) const {
  if (videos.members() == 0) return;
  auto known = lines.find(key_of_search(videos));
  // Efforts of one codec differ by tenths of a decibel at the same crf, where a search without any
  // line takes 8 to 10 encodes.
  const std::string codec = videos.search_of(0).options().codec + ":";
  if (known == lines.end())
    known =
        std::ranges::find_if(lines, [&](const auto& one) { return one.first.starts_with(codec); });
  if (known == lines.end() || known->second.size() != videos.members()) return;
  for (size_t i = 0; i < videos.members(); ++i) videos.search_of(i).go_on_from(known->second[i]);
}

void NightHistory::learn(EntityVideos& videos) {
  std::vector<VideoHistory::Line> ends;
  for (size_t i = 0; i < videos.members(); ++i) {
    const VideoHistory& history = videos.search_of(i).history();
    if (history.is_empty()) return;
    ends.push_back(history.line());
  }
  if (!ends.empty()) lines.insert_or_assign(key_of_search(videos), std::move(ends));
}

Result<uint64_t> snapshots_ever(ltm::StoreReader& reader, const ltm::MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, reader.index(entity));
  const auto& forgotten = reader.manifest().forgotten;
  const auto sums = forgotten.find(entity);
  return index->size() + (sums != forgotten.end() ? sums->second.snapshots : 0);
}

NightHistory read_history(const std::filesystem::path& store, const ltm::MemoryId& entity) {
  const std::filesystem::path file = ltm::history_file(store, entity);
  std::error_code missing;
  if (std::filesystem::file_size(file, missing) > kMaxBytes || missing) return {};
  const auto bytes = read_file(file);
  if (!bytes.ok()) {
    if (bytes.status().code() != StatusCode::kNotFound)
      log::debug("{}: no history: {}", entity.to_string(), bytes.status().message());
    return {};
  }
  const auto text = bytes->bytes();
  try {
    return history_of(Json::parse(reinterpret_cast<const char*>(text.data()),
                                  reinterpret_cast<const char*>(text.data()) + text.size()));
  } catch (const Json::exception& error) {
    log::debug("{}: its history is not used: {}", entity.to_string(), error.what());
    return {};
  }
}

void write_history(const std::filesystem::path& store, const ltm::MemoryId& entity,
                   const NightHistory& history) {
  Json videos = Json::object();
  for (const auto& [codec, members] : history.lines)
    for (const VideoHistory::Line& line : members) videos[codec].push_back(json_of(line));
  Json json = {{"networks_lost_at", history.networks_lost_at}, {"videos", std::move(videos)}};
  if (history.chain)
    json["chain"] = {{"access_ns", history.chain->access.count()}, {"rows", history.chain->rows}};
  const std::string text = json.dump();
  const Status written =
      replace_file(ltm::history_file(store, entity), std::as_bytes(std::span(text)));
  if (!written.ok())
    log::warning("{}: the next night learns nothing from this one: {}", entity.to_string(),
                 written.message());
}

}  // namespace engram::training
