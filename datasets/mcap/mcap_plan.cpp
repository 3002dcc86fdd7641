// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_plan.h"

#include <algorithm>
#include <limits>

#include "datasets/recordings/exported_streams.h"
#include "datasets/recordings/stored_streams.h"
#include "datasets/recordings/text_value.h"
#include "datasets/ros/standard_definitions.h"
#include "datasets/ros/suited_type.h"

namespace engram::datasets::mcap {

namespace {

constexpr size_t kMaxChannels = std::numeric_limits<uint16_t>::max();

std::map<std::string, std::string> texts_of(const idf::Data* value) {
  std::map<std::string, std::string> texts;
  if (const auto* dict = value == nullptr ? nullptr : value->get_if<idf::Dict>())
    for (const auto& [key, text] : *dict) texts[key] = text_of(&text);
  return texts;
}

class Planner {
 public:
  Planner(ltm::Recall& recall, const WritingOptions& options)
      : recall_(recall), options_(options) {}

  Result<ExportPlan> run(const ltm::Query& query) {
    ENGRAM_RETURN_IF_ERROR(
        visit_exported(recall_, query, "mcap", "rosbag", options_.recall, plan_.not_held,
                       [this](const ExportedStream& stream) { return add(stream); }));
    ENGRAM_RETURN_IF_ERROR(add_episodes());
    return std::move(plan_);
  }

 private:
  Status add(const ExportedStream& stream) {
    if (stream.stored && stream.stored->attributes.find(kAttachments) != nullptr) {
      if (stream.newest) plan_.attachments.insert(stream.entity);
      return {};
    }
    if (plan_.channels.size() == kMaxChannels)
      return resource_exhausted("an MCAP file has at most 65535 channels");
    auto records = records_of(stream);
    if (!records) return {};
    const ChannelCoder& coder = add(stream.entity, *std::move(records));
    if (stream.newest) tell(*stream.newest, coder);
    return {};
  }

  using Records = std::pair<ChannelRecord, SchemaRecord>;

  /// Returns nothing for an empty stream of another format that cannot become a channel.
  std::optional<Records> records_of(const ExportedStream& stream) {
    if (stream.stored) return as_imported(*stream.stored);
    if (stream.kindred) {
      if (auto records = of_connection(*stream.kindred)) return records;
      tell_description(plan_.not_held);
    }
    if (!stream.newest) return std::nullopt;
    return as_suits(stream.entity, stream.newest->instances.front().data);
  }

  /// Makes the records like programs that convert bags to MCAP files; returns nothing if the
  /// messages cannot be read.
  static std::optional<Records> of_connection(const RecordingStream& stream) {
    const idf::Data about = stream.attributes;
    auto metadata = texts_of(about.at("connection"));
    const std::string type = text_of(about.at("type"));
    const std::string definition = text_of(about.at("definition"));
    if (metadata.contains(kEntityKey) ||
        !ros::MessageType::create(type, definition, ros::Serialization::kRos1).ok())
      return std::nullopt;
    metadata["md5sum"] = text_of(about.at("md5sum"));
    return Records{{0, 0, stream.name, "ros1", std::move(metadata)},
                   {0, type, "ros1msg", definition}};
  }

  const ChannelCoder& add(const ltm::MemoryId& entity, Records records) {
    auto& [channel, schema] = records;
    channel.id = static_cast<uint16_t>(plan_.channels.size() + 1);
    if (!schema.name.empty() || !schema.encoding.empty()) channel.schema_id = add(schema);
    ChannelCoder coder = ChannelCoder::create(channel, &schema);
    return plan_.channels.emplace(entity, PlannedChannel{std::move(channel), std::move(coder)})
        .first->second.coder;
  }

  /// Equal schemas are written once, because many channels have the same type.
  uint16_t add(SchemaRecord& schema) {
    for (const SchemaRecord& known : plan_.schemas) {
      schema.id = known.id;
      if (known == schema) return known.id;
    }
    schema.id = static_cast<uint16_t>(plan_.schemas.size() + 1);
    plan_.schemas.push_back(schema);
    return schema.id;
  }

  void tell(const ltm::SnapshotResult& snapshot, const ChannelCoder& coder) {
    const ltm::InstanceResult& first = snapshot.instances.front();
    tell_metadata(snapshot, plan_.not_held);
    if (coder.ros_type() != nullptr && coder.ros_type()->is_lossy(options_.jpeg_quality))
      ++plan_.not_held["exact pixels: JPEG was asked for"];
    // A trial encoding of the newest value tells in advance what the export would leave out.
    if (!coder.encode(first.data, 0).ok())
      ++plan_.not_held["values that are no messages of their channel's type"];
  }

  static Records as_imported(const RecordingStream& stream) {
    const idf::Data attributes = stream.attributes;
    ChannelRecord channel{0, 0, stream.name, text_of(attributes.at("message_encoding")),
                          texts_of(attributes.at("metadata"))};
    SchemaRecord schema{0, text_of(attributes.at("schema/name")),
                        text_of(attributes.at("schema/encoding")),
                        text_of(attributes.at("schema/data"))};
    return {std::move(channel), std::move(schema)};
  }

  Records as_suits(const ltm::MemoryId& entity, const idf::Data& value) const {
    ChannelRecord channel{0, 0, topic_of_entity(entity), "cdr", {{kEntityKey, entity.to_string()}}};
    std::string type(ros::suited_type(value, options_.jpeg_quality > 0));
    if (const auto definition = ros::standard_definition(type, ros::Serialization::kCdr)) {
      type.insert(type.find('/'), "/msg");
      return {channel, {0, type, "ros2msg", std::string(*definition)}};
    }
    channel.message_encoding = "json";
    return {channel,
            {0, "engram.Value", "jsonschema",
             R"({"type": ["object", "array", "string", "number", "boolean", "null"]})"}};
  }

  Status add_episodes() {
    const ltm::MemoryId about = episode_entity("mcap");
    const auto known = recall_.store().entities();
    if (std::ranges::find(known, about) == known.end()) return {};
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall_.store().timeline(about));
    ENGRAM_ASSIGN_OR_RETURN(auto entry, timeline->at_or_after(Time::min()));
    while (entry) {
      ENGRAM_ASSIGN_OR_RETURN(
          const auto snapshot,
          recalled_snapshot(recall_, about, {*entry, false, {}}, options_.recall));
      if (snapshot && !snapshot->instances.empty()) add_episode(snapshot->instances.front().data);
      if (entry->time == Time::max()) break;
      ENGRAM_ASSIGN_OR_RETURN(entry, timeline->at_or_after(entry->time + Duration(1)));
    }
    return {};
  }

  void add_episode(const idf::Data& value) {
    const auto episode = RecordingEpisode::from_data(value);
    if (!episode.ok()) return;
    const idf::Data attributes = episode->attributes;
    if (plan_.profile.empty()) plan_.profile = text_of(attributes.at("profile"));
    const idf::Data* metadata = attributes.at("metadata");
    if (metadata == nullptr || !metadata->is<idf::List>()) return;
    for (const idf::Data& one : metadata->get<idf::List>()) {
      MetadataRecord record{text_of(one.at("name")), texts_of(one.at("metadata"))};
      if (std::ranges::find(plan_.metadata, record) == plan_.metadata.end())
        plan_.metadata.push_back(std::move(record));
    }
  }

  ltm::Recall& recall_;
  const WritingOptions& options_;
  ExportPlan plan_;
};

}  // namespace

Result<ExportPlan> plan_export(ltm::Recall& recall, const ltm::Query& query,
                               const WritingOptions& options) {
  return Planner(recall, options).run(query);
}

}  // namespace engram::datasets::mcap
