// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/recording_reader.h"

namespace engram::datasets {

namespace {

constexpr const char* kMemory = "Recording";

/// Reads a member of a description.
template <typename Value>
Result<Value> member(const idf::Data& data, const char* what, const char* name) {
  const idf::Data* found = data.at(name);
  if (found == nullptr || !found->is<Value>())
    return invalid_argument("{}: needs '{}'", what, name);
  return found->get<Value>();
}

/// Replaces dots, which separate names; different names give different results.
std::string undotted(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (c == '.')
      text += "%2E";
    else if (c == '%')
      text += "%25";
    else
      text += c;
  }
  return text;
}

}  // namespace

idf::Data RecordingStream::to_data() const {
  return idf::Dict{{"entity", entity.to_string()}, {"name", name}, {"attributes", attributes}};
}

Result<RecordingStream> RecordingStream::from_data(const idf::Data& data) {
  constexpr const char* kWhat = "description of a stream";
  RecordingStream stream;
  ENGRAM_ASSIGN_OR_RETURN(const auto entity, member<std::string>(data, kWhat, "entity"));
  ENGRAM_ASSIGN_OR_RETURN(stream.entity, ltm::MemoryId::parse(entity));
  if (!stream.entity.is_entity())
    return invalid_argument("{}: '{}' is no entity, needs four names", kWhat, entity);
  ENGRAM_ASSIGN_OR_RETURN(stream.name, member<std::string>(data, kWhat, "name"));
  ENGRAM_ASSIGN_OR_RETURN(stream.attributes, member<idf::Dict>(data, kWhat, "attributes"));
  return stream;
}

idf::Data RecordingEpisode::to_data() const {
  return idf::Dict{
      {"format", format}, {"name", name}, {"start_ns", to_ns(start)}, {"attributes", attributes}};
}

Result<RecordingEpisode> RecordingEpisode::from_data(const idf::Data& data) {
  constexpr const char* kWhat = "description of an episode";
  RecordingEpisode episode;
  ENGRAM_ASSIGN_OR_RETURN(episode.format, member<std::string>(data, kWhat, "format"));
  ENGRAM_ASSIGN_OR_RETURN(episode.name, member<std::string>(data, kWhat, "name"));
  ENGRAM_ASSIGN_OR_RETURN(const auto start, member<int64_t>(data, kWhat, "start_ns"));
  episode.start = time_from_ns(start);
  ENGRAM_ASSIGN_OR_RETURN(episode.attributes, member<idf::Dict>(data, kWhat, "attributes"));
  return episode;
}

ltm::EntityUpdate imported(const ltm::MemoryId& entity, Time time, idf::Data value) {
  return {
      entity,
      time,
      {{std::move(value), {.created = time, .sent = time, .arrived = time, .provider = "import"}}}};
}

ltm::MemoryId stream_entity(std::string_view format, const ltm::MemoryId& entity) {
  const auto& names = entity.names();
  std::string name;
  for (size_t i = 0; i + 1 < names.size(); ++i) name += undotted(names[i]) + ".";
  name += names.back();  // The last name may have dots, because nothing follows it.
  return ltm::MemoryId::from_names({kMemory, "Streams", std::string(format), name}).value();
}

ltm::MemoryId episode_entity(std::string_view format) {
  return ltm::MemoryId::from_names({kMemory, "Episodes", std::string(format), "episodes"}).value();
}

}  // namespace engram::datasets
