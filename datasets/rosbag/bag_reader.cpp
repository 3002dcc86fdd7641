// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_reader.h"

#include <algorithm>

#include "datasets/recordings/text_value.h"
#include "datasets/ros/message_digest.h"
#include "ltm/core/utf8.h"

namespace engram::datasets::rosbag {

Result<std::unique_ptr<RecordingReader>> BagReader::open(const std::filesystem::path& path,
                                                         const ReadingOptions& options) {
  if (!options.episodes.empty())
    return invalid_argument(
        "'{}': a bag is one recording without a name, episode '{}' was asked for", path.string(),
        options.episodes.front());
  const auto provider = ltm::MemoryId::from_names({"Data", "rosbag", options.provider});
  if (!provider.ok()) return provider.status().with_context("provider");
  ENGRAM_ASSIGN_OR_RETURN(FileWindow file, FileWindow::open(path));
  std::unique_ptr<BagReader> reader(new BagReader(std::move(file), options));
  ENGRAM_RETURN_IF_ERROR(reader->prepare());
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

Status BagReader::prepare() {
  ENGRAM_ASSIGN_OR_RETURN(map_, map_bag(file_, report_));
  for (const auto& [id, connection] : map_.connections)
    ENGRAM_RETURN_IF_ERROR(add_topic(connection));
  loaded_ = {};
  for (const Region& region : map_.regions) total_ += region.messages;
  messages_ = std::make_unique<OrderedRegions>(
      [this](const Region& region) { return load(region); }, std::move(map_.regions));
  map_ = {};
  return {};
}

Status BagReader::add_topic(const Connection& connection) {
  ConnectionCoder coder = ConnectionCoder::create(connection);
  const auto md5 = ros::message_md5(connection.type, connection.definition);
  const bool says_md5 = !connection.md5sum.empty() && connection.md5sum != "*";
  if (says_md5 && md5.ok() && *md5 != connection.md5sum)
    ++report_.not_carried["definitions that do not have the MD5 sum of their connection"];
  std::optional<idf::Data> first;
  if (coder.type() != nullptr && coder.type()->is_image()) {
    auto value = first_value(connection.id, coder);
    if (!value.ok() && value.status().code() == StatusCode::kUnavailable) return value.status();
    if (value.ok()) first = *std::move(value);
  }
  ros::SegmentNames segment{"Data", "rosbag"};
  if (coder.type() != nullptr)
    segment = coder.type()->segment(first ? &*first : nullptr).value_or(segment);
  const std::string* own = connection.find(kEntityField);
  ENGRAM_ASSIGN_OR_RETURN(
      const auto entity,
      entities_.take_own(
          own == nullptr ? "" : *own, segment.memory, segment.segment, options_.provider,
          name_of_topic(connection.topic, fmt::format("connection_{}", connection.id))));
  const auto& [id, topic] =
      *topics_.emplace(connection.id, Topic{entity, std::move(coder), std::nullopt}).first;
  describe(connection, topic);
  return {};
}

void BagReader::describe(const Connection& connection, const Topic& topic) {
  RecordingStream stream;
  stream.entity = topic.entity;
  stream.name = connection.topic;
  if (!is_utf8(connection.topic)) {
    stream.name = fmt::format("connection_{}", connection.id);
    ++report_.not_carried["topics that are no UTF-8, renamed"];
  }
  stream.values = map_.messages[connection.id];
  idf::Dict others;
  for (const auto& [name, value] : connection.others) {
    if (is_utf8(name))
      others.set(name, text_value(value));
    else
      ++report_.not_carried["fields of connections whose names are no UTF-8"];
  }
  stream.attributes = {{"type", text_value(connection.type)},
                       {"md5sum", text_value(connection.md5sum)},
                       {"definition", text_value(connection.definition)},
                       {"connection", std::move(others)}};
  const std::string& problem = topic.coder.problem();
  if (!problem.empty() && is_utf8(problem)) stream.attributes.set("kept_as_bytes", problem);
  streams_.push_back(std::move(stream));
}

void BagReader::note(const std::string& what) {
  // A damaged file may have a million faults; the report stays readable.
  constexpr size_t kMaxNotes = 40;
  ++report_.not_carried[report_.not_carried.size() < kMaxNotes ? what : "further damaged chunks"];
}

Result<RegionMessages> BagReader::load(const Region& region) {
  std::string problem;
  ENGRAM_ASSIGN_OR_RETURN(LoadedRegion loaded, load_region(file_, region, problem));
  const uint64_t missing =
      region.messages - std::min<uint64_t>(region.messages, loaded.entries.size());
  if (problem.empty() && missing > 0)
    problem =
        fmt::format("'{}', offset {}: chunk of {} messages, its index says {}",
                    file_.path().string(), region.offset, loaded.entries.size(), region.messages);
  // A region is reported once, although it may be read again if memory is short.
  if (!problem.empty() && told_.insert(region.offset).second) {
    report_.damaged += std::max<uint64_t>(missing, 1);
    note(problem);
  }
  return RegionMessages(std::move(loaded));
}

Result<idf::Data> BagReader::first_value(uint32_t connection, const ConnectionCoder& coder) {
  const auto found = map_.first_region.find(connection);
  if (found == map_.first_region.end())
    return not_found("connection {} has no message", connection);
  if (loaded_index_ != found->second) {
    loaded_index_.reset();
    std::string problem;  // It is reported when the region is read in order.
    ENGRAM_ASSIGN_OR_RETURN(loaded_, load_region(file_, map_.regions[found->second], problem));
    loaded_index_ = found->second;
  }
  for (const auto& entry : loaded_.entries) {
    const Message message = message_at(loaded_.bytes.bytes().subspan(entry.offset));
    if (message.connection != connection) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto decoded, coder.decode(message.data));
    return std::move(decoded.value);
  }
  return not_found("connection {} has no message where its index says", connection);
}

std::optional<ltm::EntityUpdate> BagReader::update_of(Topic& topic, const Message& message) {
  auto decoded = topic.coder.decode(message.data);
  if (!decoded.ok()) {
    ++report_.damaged;
    note(fmt::format("messages of '{}': {}", topic.entity.to_string(), decoded.status().message()));
    return std::nullopt;
  }
  // This fits, because seconds and nanoseconds have 32 bits each.
  ltm::EntityUpdate update{topic.entity, shift_.shifted(static_cast<int64_t>(message.time)), {}};
  ltm::InstanceMetadata metadata{
      .created = update.time, .sent = update.time, .arrived = update.time, .provider = "import"};
  if (decoded->stamp && to_ns(*decoded->stamp) >= 0)
    metadata.created = shift_.shifted(to_ns(*decoded->stamp));
  update.instances.push_back({std::move(decoded->value), std::move(metadata)});
  order_.put(topic.last_time == message.time, update, report_);
  topic.last_time = message.time;
  return update;
}

Result<std::optional<ltm::EntityUpdate>> BagReader::pull() {
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, messages_->next(report_));
    if (!bytes) return std::optional<ltm::EntityUpdate>();
    const Message message = message_at(*bytes);
    const auto topic = topics_.find(message.connection);
    if (topic == topics_.end()) {
      ++report_.damaged;
      ++report_.not_carried["messages of connections that the file does not describe"];
      continue;
    }
    if (auto update = update_of(topic->second, message)) return update;
  }
}

Result<std::optional<RecordingReader::Moment>> BagReader::next() {
  ENGRAM_ASSIGN_OR_RETURN(const auto time, moments_.next_time());
  Moment moment;
  if (!has_begun_ && (time || !streams_.empty()))
    moment.begins =
        RecordingEpisode{"rosbag", "", time.value_or(options_.start.value_or(Time{})), {}};
  has_begun_ = true;
  if (!time) return moment.begins ? std::optional(std::move(moment)) : std::nullopt;
  ENGRAM_RETURN_IF_ERROR(moments_.take(moment.commit));
  return std::optional(std::move(moment));
}

}  // namespace engram::datasets::rosbag
