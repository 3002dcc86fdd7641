// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_reader.h"

#include <algorithm>
#include <limits>

#include "datasets/recordings/text_value.h"
#include "ltm/core/utf8.h"

namespace engram::datasets::mcap {

namespace {

constexpr uint64_t kMaxTime = std::numeric_limits<int64_t>::max();

idf::Dict texts_value(const std::map<std::string, std::string>& texts, ReadingReport& report) {
  idf::Dict value;
  for (const auto& [key, text] : texts) {
    if (is_utf8(key))
      value.set(key, text_value(text));
    else
      ++report.not_carried["keys of metadata that are no UTF-8"];
  }
  return value;
}

}  // namespace

Result<std::unique_ptr<RecordingReader>> McapReader::open(const std::filesystem::path& path,
                                                          const ReadingOptions& options) {
  if (!options.episodes.empty())
    return invalid_argument(
        "'{}': an MCAP file is one recording without a name, episode '{}' was "
        "asked for",
        path.string(), options.episodes.front());
  const auto provider = ltm::MemoryId::from_names({"Data", "mcap", options.provider});
  if (!provider.ok()) return provider.status().with_context("provider");
  ENGRAM_ASSIGN_OR_RETURN(FileWindow file, FileWindow::open(path));
  std::unique_ptr<McapReader> reader(new McapReader(std::move(file), options));
  ENGRAM_RETURN_IF_ERROR(reader->prepare());
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

Status McapReader::prepare() {
  ENGRAM_ASSIGN_OR_RETURN(map_, map_file(file_, report_));
  ENGRAM_RETURN_IF_ERROR(add_channels());
  if (!map_.attachments.empty()) ENGRAM_RETURN_IF_ERROR(describe_attachments());
  loaded_ = {};
  for (const Region& region : map_.regions) total_ += region.messages;
  messages_ = std::make_unique<OrderedMessages>(file_, std::move(map_.regions));
  map_.regions.clear();
  return {};
}

Status McapReader::add_channels() {
  for (const auto& [id, channel] : map_.channels) {
    const auto schema = map_.schemas.find(channel.schema_id);
    const SchemaRecord* found = schema == map_.schemas.end() ? nullptr : &schema->second;
    ChannelCoder coder = ChannelCoder::create(channel, found);
    // Only pixels tell colour from depth, and the entity must be known before the first message, so
    // one value of every image channel is decoded in advance.
    std::optional<idf::Data> first;
    if (coder.ros_type() != nullptr && coder.ros_type()->is_image()) {
      auto value = first_value(id, coder);
      if (!value.ok() && value.status().code() == StatusCode::kUnavailable) return value.status();
      if (value.ok()) first = *std::move(value);
    }
    ros::SegmentNames segment{"Data", "mcap"};
    if (coder.ros_type() != nullptr)
      segment = coder.ros_type()->segment(first ? &*first : nullptr).value_or(segment);
    const auto own = channel.metadata.find(kEntityKey);
    ENGRAM_ASSIGN_OR_RETURN(
        const auto entity,
        entities_.take_own(own == channel.metadata.end() ? "" : own->second, segment.memory,
                           segment.segment, options_.provider,
                           name_of_topic(channel.topic, fmt::format("channel_{}", id))));
    channels_.emplace(id, Channel{entity, std::move(coder), std::nullopt, std::nullopt});
    describe(channel, found);
  }
  return {};
}

void McapReader::describe(const ChannelRecord& channel, const SchemaRecord* schema) {
  RecordingStream stream;
  stream.entity = channels_.at(channel.id).entity;
  stream.name = channel.topic;
  if (!is_utf8(channel.topic)) {
    stream.name = fmt::format("channel_{}", channel.id);
    ++report_.not_carried["topics that are no UTF-8, renamed"];
  }
  if (map_.statistics) {
    const auto count = map_.statistics->channel_message_counts.find(channel.id);
    if (count != map_.statistics->channel_message_counts.end()) stream.values = count->second;
  }
  stream.attributes = {{"message_encoding", text_value(channel.message_encoding)},
                       {"metadata", texts_value(channel.metadata, report_)}};
  if (schema != nullptr)
    stream.attributes.set("schema", idf::Dict{{"name", text_value(schema->name)},
                                              {"encoding", text_value(schema->encoding)},
                                              {"data", text_value(schema->data)}});
  const std::string& problem = channels_.at(channel.id).coder.problem();
  if (!problem.empty() && is_utf8(problem)) stream.attributes.set("kept_as_bytes", problem);
  streams_.push_back(std::move(stream));
}

Result<idf::Data> McapReader::first_value(uint16_t id, const ChannelCoder& coder) {
  const auto found = map_.first_region.find(id);
  if (found == map_.first_region.end()) return not_found("channel {} has no message", id);
  if (loaded_index_ != found->second) {
    loaded_index_.reset();
    ENGRAM_ASSIGN_OR_RETURN(loaded_, load_region(file_, map_.regions[found->second]));
    loaded_index_ = found->second;
  }
  for (const auto& entry : loaded_.entries) {
    const MessageRecord message = message_at(loaded_, entry);
    if (message.channel_id == id) return coder.decode(message.data);
  }
  return not_found("channel {} has no message where its index says", id);
}

Time McapReader::shifted(uint64_t ns) {
  return shift_.shifted(static_cast<int64_t>(std::min(ns, kMaxTime)));
}

void McapReader::watch_sequence(Channel& channel, uint32_t sequence) {
  // Writers that do not count write 0 for all messages, which is no gap.
  if (channel.sequence && sequence != *channel.sequence + 1 &&
      (sequence != 0 || *channel.sequence != 0))
    ++report_.not_carried["sequence numbers that do not count on"];
  channel.sequence = sequence;
}

std::optional<ltm::EntityUpdate> McapReader::update_of(Channel& channel,
                                                       const MessageRecord& message) {
  watch_sequence(channel, message.sequence);
  auto value = message.log_time > kMaxTime
                   ? data_loss("log time {} is after the year 2262", message.log_time)
                   : channel.coder.decode(message.data);
  if (!value.ok()) {
    ++report_.damaged;
    constexpr size_t kMaxNotes = 40;
    if (report_.not_carried.size() < kMaxNotes)
      ++report_.not_carried[fmt::format("messages of '{}': {}", channel.entity.to_string(),
                                        value.status().message())];
    return std::nullopt;
  }
  ltm::EntityUpdate update{channel.entity, shifted(message.log_time), {}};
  ltm::InstanceMetadata metadata{.created = shifted(message.publish_time),
                                 .sent = shifted(message.publish_time),
                                 .arrived = update.time,
                                 .provider = "import"};
  if (const auto stamp = ros::header_stamp(*value); stamp && to_ns(*stamp) >= 0)
    metadata.created = shifted(static_cast<uint64_t>(to_ns(*stamp)));
  update.instances.push_back({*std::move(value), std::move(metadata)});
  put_in_order(channel.last_log_time, message.log_time, update);
  return update;
}

Status McapReader::describe_attachments() {
  ENGRAM_ASSIGN_OR_RETURN(attachments_,
                          entities_.take("Data", "mcap", options_.provider, "attachments"));
  streams_.push_back({attachments_, "", map_.attachments.size(), {{kAttachments, true}}});
  total_ += map_.attachments.size();
  return {};
}

Result<std::optional<ltm::EntityUpdate>> McapReader::next_attachment() {
  const AttachmentPlace& place = map_.attachments[next_attachment_++];
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes, file_.read(place.offset, place.length));
  const auto record = read_attachment(bytes);
  if (!record.ok() || record->log_time > kMaxTime) {
    ++report_.damaged;
    ++report_.not_carried[fmt::format(
        "'{}', offset {}: {}", file_.path().string(), place.offset,
        record.ok() ? "log time is after the year 2262" : record.status().message())];
    return std::optional<ltm::EntityUpdate>();
  }
  ltm::EntityUpdate update{attachments_, shifted(record->log_time), {}};
  ltm::InstanceMetadata metadata{
      .created = update.time, .sent = update.time, .arrived = update.time, .provider = "import"};
  if (record->create_time != 0) metadata.created = shifted(record->create_time);
  ENGRAM_ASSIGN_OR_RETURN(
      auto data,
      idf::NdArray::create(idf::ElementType::kUInt8, {static_cast<int64_t>(record->data.size())},
                           Buffer::copy(record->data)));
  update.instances.push_back({idf::Dict{{"name", text_value(record->name)},
                                        {"media_type", text_value(record->media_type)},
                                        {"has_create_time", record->create_time != 0},
                                        {"data", std::move(data)}},
                              std::move(metadata)});
  put_in_order(last_attachment_time_, record->log_time, update);
  return std::optional(std::move(update));
}

void McapReader::put_in_order(std::optional<uint64_t>& last_log_time, uint64_t log_time,
                              ltm::EntityUpdate& update) {
  const bool repeats = last_log_time == log_time;
  last_log_time = log_time;
  order_.put(repeats, update, report_);
}

Result<std::optional<ltm::EntityUpdate>> McapReader::pull() {
  while (true) {
    if (!message_) {
      ENGRAM_ASSIGN_OR_RETURN(message_, messages_->next(report_));
    }
    if (next_attachment_ < map_.attachments.size() &&
        (!message_ || map_.attachments[next_attachment_].log_time <= message_->log_time)) {
      ENGRAM_ASSIGN_OR_RETURN(auto update, next_attachment());
      if (update) return update;
      continue;
    }
    if (!message_) return std::optional<ltm::EntityUpdate>();
    const auto message = std::exchange(message_, std::nullopt);
    const auto channel = channels_.find(message->channel_id);
    if (channel == channels_.end()) {
      ++report_.damaged;
      ++report_.not_carried["messages of channels that the file does not describe"];
      continue;
    }
    if (auto update = update_of(channel->second, *message)) return update;
  }
}

RecordingEpisode McapReader::episode(Time start) {
  RecordingEpisode episode{"mcap", "", start, {}};
  idf::List metadata;
  for (const MetadataRecord& record : map_.metadata)
    metadata.push_back(idf::Dict{{"name", text_value(record.name)},
                                 {"metadata", texts_value(record.metadata, report_)}});
  episode.attributes = {{"profile", text_value(map_.header.profile)},
                        {"library", text_value(map_.header.library)},
                        {"metadata", std::move(metadata)}};
  return episode;
}

Result<std::optional<RecordingReader::Moment>> McapReader::next() {
  ENGRAM_ASSIGN_OR_RETURN(const auto time, moments_.next_time());
  Moment moment;
  if (!has_begun_ && (time || !streams_.empty() || !map_.metadata.empty()))
    moment.begins = episode(time.value_or(options_.start.value_or(Time{})));
  has_begun_ = true;
  if (!time) return moment.begins ? std::optional(std::move(moment)) : std::nullopt;
  ENGRAM_RETURN_IF_ERROR(moments_.take(moment.commit));
  return std::optional(std::move(moment));
}

}  // namespace engram::datasets::mcap
