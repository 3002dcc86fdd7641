// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_plan.h"

#include <set>

#include "datasets/recordings/stored_streams.h"
#include "datasets/recordings/text_value.h"

namespace engram::datasets::rosbag {

namespace {

/// Makes a topic; names of ROS may only have letters, digits, '_' and '/'.
std::string ros_topic(const ltm::MemoryId& entity) {
  constexpr std::string_view kSigns =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_/";
  std::string topic = topic_of_entity(entity);
  for (char& sign : topic)
    if (kSigns.find(sign) == std::string_view::npos) sign = '_';
  return topic;
}

/// Returns the connection as it was imported.
Connection as_imported(uint32_t id, const RecordingStream& stream) {
  const idf::Data about = stream.attributes;
  Connection connection{id,
                        stream.name,
                        text_of(about.at("type")),
                        text_of(about.at("md5sum")),
                        text_of(about.at("definition")),
                        {}};
  const idf::Data* others = about.at("connection");
  if (const auto* fields = others == nullptr ? nullptr : others->get_if<idf::Dict>())
    for (const auto& [name, value] : *fields) connection.others.emplace_back(name, text_of(&value));
  return connection;
}

/// Converts a channel of ROS 1 messages to the connection that it was, or could have been. Returns
/// nothing if the messages are others, or cannot be read.
std::optional<Connection> of_channel(uint32_t id, const RecordingStream& stream) {
  const idf::Data about = stream.attributes;
  Connection connection{
      id, stream.name, text_of(about.at("schema/name")), "", text_of(about.at("schema/data")), {}};
  connection.md5sum = md5_or_any(connection.type, connection.definition);
  connection.others.emplace_back("topic", stream.name);
  const idf::Data* metadata = about.at("metadata");
  if (const auto* fields = metadata == nullptr ? nullptr : metadata->get_if<idf::Dict>())
    for (const auto& [name, value] : *fields) {
      if (name == "md5sum")
        connection.md5sum = text_of(&value);
      else if (name == "topic")
        connection.others.front().second = text_of(&value);
      else if (name != "type" && name != "message_definition")
        connection.others.emplace_back(name, text_of(&value));
    }
  const bool is_ros1 = text_of(about.at("message_encoding")) == "ros1" &&
                       text_of(about.at("schema/encoding")) == "ros1msg" &&
                       connection.find(kEntityField) == nullptr &&
                       ConnectionCoder::create(connection).type() != nullptr;
  return is_ros1 ? std::optional(std::move(connection)) : std::nullopt;
}

class Planner {
 public:
  Planner(const WritingOptions& options, ExportPlan& plan) : options_(options), plan_(plan) {}

  void add(const ExportedStream& stream) {
    const auto id = static_cast<uint32_t>(plan_.connections.size());
    auto found = connection_of(id, stream);
    if (!found) return;
    Connection connection = *std::move(found);
    ConnectionCoder coder = ConnectionCoder::create(connection);
    if (stream.newest) tell(*stream.newest, coder);
    topics_.insert(connection.topic);
    plan_.connections.emplace(stream.entity,
                              PlannedConnection{std::move(connection), std::move(coder)});
  }

 private:
  /// Returns nothing for an empty stream of another format that cannot become a connection.
  std::optional<Connection> connection_of(uint32_t id, const ExportedStream& stream) {
    if (stream.stored) return as_imported(id, *stream.stored);
    if (stream.kindred) {
      if (auto connection = of_channel(id, *stream.kindred)) return connection;
      tell_description(plan_.not_held);
    }
    if (!stream.newest) return std::nullopt;
    return as_suits(id, stream);
  }

  Connection as_suits(uint32_t id, const ExportedStream& stream) {
    const std::string wanted = ros_topic(stream.entity);
    std::string topic = wanted;
    for (int i = 2; topics_.contains(topic); ++i) topic = fmt::format("{}_{}", wanted, i);
    return own_connection(id, topic, stream.entity, stream.newest->instances.front().data,
                          options_.jpeg_quality > 0);
  }

  void tell(const ltm::SnapshotResult& snapshot, const ConnectionCoder& coder) {
    const ltm::InstanceResult& first = snapshot.instances.front();
    const Time created = first.metadata.created;
    tell_metadata(snapshot, plan_.not_held);
    if (first.metadata.sent != snapshot.time || first.metadata.arrived != snapshot.time)
      ++plan_.not_held["times of sending and arrival"];
    if (coder.is_json()) ++plan_.not_held["types of values: written as JSON in std_msgs/String"];
    if (coder.type() != nullptr && coder.type()->is_lossy(options_.jpeg_quality))
      ++plan_.not_held["exact pixels: JPEG was asked for"];
    const auto bytes = coder.encode(first.data, created, 0);
    if (!bytes.ok()) {
      ++plan_.not_held["values that are no messages of their connection's type"];
      return;
    }
    const auto read = coder.decode(*bytes);
    if (created != snapshot.time && (!read.ok() || read->stamp != created))
      ++plan_.not_held["times of creation, where messages have no header with them"];
  }

  const WritingOptions& options_;
  ExportPlan& plan_;
  std::set<std::string> topics_;
};

}  // namespace

Result<ExportPlan> plan_export(ltm::Recall& recall, const ltm::Query& query,
                               const WritingOptions& options) {
  ExportPlan plan;
  Planner planner(options, plan);
  ENGRAM_RETURN_IF_ERROR(visit_exported(recall, query, "rosbag", "mcap", options.recall,
                                        plan.not_held, [&](const ExportedStream& stream) {
                                          planner.add(stream);
                                          return Status();
                                        }));
  return plan;
}

}  // namespace engram::datasets::rosbag
