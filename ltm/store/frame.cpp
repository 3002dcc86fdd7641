// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/frame.h"

#include <algorithm>

#include "ltm/codec/group_codec.h"
#include "ltm/codec/zstd.h"
#include "ltm/idf/binary.h"

namespace engram::ltm {

namespace {

using idf::Data;
using idf::Dict;
using idf::List;
using idf::NdArray;

/// Max plain size of a value without its media, in bytes.
constexpr size_t kMaxRestBytes = size_t{1} << 30;

NdArray bytes_array(Buffer bytes) {
  const auto size = static_cast<int64_t>(bytes.size());
  auto array = NdArray::create(idf::ElementType::kUInt8, {size}, std::move(bytes));
  ENGRAM_CHECK(array.ok(), "{}", array.status().message());
  return std::move(array).value();
}

/// Reads members of a dict and remembers whether one was missing or had another kind. A frame comes
/// from a file and may hold anything, so one check of `status` after all reads replaces one per
/// member.
class DictReader {
 public:
  explicit DictReader(const Data& data) : dict_(data.get_if<Dict>()) {}

  template <typename T>
  T get(std::string_view key) {
    const Data* value = dict_ == nullptr ? nullptr : dict_->find(key);
    const T* typed = value == nullptr ? nullptr : value->get_if<T>();
    if (typed != nullptr) return *typed;
    if (missing_.empty()) missing_ = key;
    return T{};
  }

  uint64_t count(std::string_view key) {
    const auto value = get<int64_t>(key);
    if (value < 0 && missing_.empty()) missing_ = key;
    return static_cast<uint64_t>(value);
  }

  [[nodiscard]] Status status() const {
    if (missing_.empty()) return {};
    return data_loss("journal frame: member '{}' is missing or broken", missing_);
  }

 private:
  const Dict* dict_;
  std::string missing_;
};

Data medium_to_data(const PackedMedium& medium) {
  List shape;
  for (const int64_t size : medium.shape) shape.emplace_back(size);
  return Dict{{"path", medium.path},
              {"codec", medium.codec},
              {"type", std::string(to_string(medium.type))},
              {"shape", std::move(shape)},
              {"bytes", bytes_array(medium.bytes)}};
}

Result<PackedMedium> medium_from_data(const Data& data) {
  DictReader reader(data);
  PackedMedium medium{reader.get<std::string>("path"),
                      reader.get<std::string>("codec"),
                      {},
                      {},
                      reader.get<NdArray>("bytes").buffer()};
  const auto type = idf::element_type_from_name(reader.get<std::string>("type"));
  const auto shape = reader.get<List>("shape");
  ENGRAM_RETURN_IF_ERROR(reader.status());
  if (!type) return data_loss("journal frame: medium '{}' has an unknown type", medium.path);
  medium.type = *type;
  for (const Data& size : shape) {
    if (!size.is<int64_t>())
      return data_loss("journal frame: medium '{}' has no shape", medium.path);
    medium.shape.push_back(size.get<int64_t>());
  }
  return medium;
}

/// Makes a medium independent of its group, because the other frames of the group may never be
/// written.
Result<PackedMedium> outside_its_group(const PackedMedium& medium, MediumDecoder& decoder) {
  const GroupCodec* codec = find_group_codec(medium.codec);
  if (codec != nullptr && !codec->is_lossless())
    return invalid_argument(
        "medium '{}': is of a group of '{}', which has loss: a journal would have it encoded once "
        "more when it is sealed; needs the image as it was before, or a segment",
        medium.path, medium.codec);
  return pack_alone(medium, decoder);
}

Result<Data> instance_to_data(const PackedInstance& instance) {
  List media;
  MediumDecoder decoder;
  for (const PackedMedium& medium : instance.value.media) {
    if (!medium.group) {
      media.push_back(medium_to_data(medium));
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(const PackedMedium alone, outside_its_group(medium, decoder));
    media.push_back(medium_to_data(alone));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto rest, idf::encode(instance.value.rest));
  // The reader refuses larger values, because a hostile file may claim any plain size. Such a value
  // must not be acknowledged.
  if (rest.size() > kMaxRestBytes)
    return invalid_argument("a value has {} bytes beside its media, at most {} fit", rest.size(),
                            kMaxRestBytes);
  return Data(Dict{{"rest", bytes_array(Buffer::take(compress_zstd(rest)))},
                   {"media", std::move(media)},
                   {"metadata", metadata_to_data(instance.metadata)}});
}

Result<PackedInstance> instance_from_data(const Data& data) {
  DictReader reader(data);
  const auto rest = reader.get<NdArray>("rest");
  const auto media = reader.get<List>("media");
  ENGRAM_RETURN_IF_ERROR(reader.status());
  PackedInstance instance;
  ENGRAM_ASSIGN_OR_RETURN(auto plain, decompress_zstd(rest.bytes(), kMaxRestBytes));
  ENGRAM_ASSIGN_OR_RETURN(instance.value.rest, idf::decode(Buffer::take(std::move(plain))));
  for (const Data& medium : media) {
    ENGRAM_ASSIGN_OR_RETURN(PackedMedium unpacked, medium_from_data(medium));
    instance.value.media.push_back(std::move(unpacked));
  }
  const Data* metadata = data.at("metadata");
  ENGRAM_ASSIGN_OR_RETURN(instance.metadata, metadata_from_data(metadata ? *metadata : Data()));
  return instance;
}

/// True if the instance, in the form it has in a frame, is augmented.
bool is_augmented(const Data& instance) {
  return instance.at("metadata/recipe") != nullptr || instance.at("metadata/origin") != nullptr;
}

Result<FrameHead> head_from_data(const Data& data) {
  DictReader reader(data);
  FrameHead head;
  const auto entity = reader.get<std::string>("entity");
  head.time = time_from_ns(reader.get<int64_t>("time"));
  head.raw_bytes = reader.count("raw_bytes");
  head.dropped = reader.count("dropped");
  head.dropped_bytes = reader.count("dropped_bytes");
  const auto instances = reader.get<List>("instances");
  head.instances = instances.size();
  head.is_augmented = std::ranges::any_of(instances, is_augmented);
  ENGRAM_RETURN_IF_ERROR(reader.status());
  ENGRAM_ASSIGN_OR_RETURN(head.entity, MemoryId::parse(entity));
  if (!head.entity.is_entity()) return data_loss("journal frame: '{}' is no entity", entity);
  return head;
}

}  // namespace

Data metadata_to_data(const InstanceMetadata& metadata) {
  return metadata.to_data();
}

Result<InstanceMetadata> metadata_from_data(const Data& data) {
  DictReader reader(data);
  InstanceMetadata metadata;
  metadata.created = time_from_ns(reader.get<int64_t>("created"));
  metadata.sent = time_from_ns(reader.get<int64_t>("sent"));
  metadata.arrived = time_from_ns(reader.get<int64_t>("arrived"));
  metadata.provider = reader.get<std::string>("provider");
  metadata.confidence = reader.get<float>("confidence");
  const std::string origin = data.at("origin") == nullptr ? "" : reader.get<std::string>("origin");
  if (data.at("recipe") != nullptr) metadata.recipe = reader.get<std::string>("recipe");
  ENGRAM_RETURN_IF_ERROR(reader.status());
  const auto id = MemoryId::parse(origin);
  if (!id.ok()) return data_loss("journal frame: origin: {}", id.status().message());
  metadata.origin = *id;
  return metadata;
}

Result<std::vector<std::byte>> encode_frame(const PackedSnapshot& snapshot) {
  List instances;
  for (const PackedInstance& instance : snapshot.instances) {
    ENGRAM_ASSIGN_OR_RETURN(Data data, instance_to_data(instance));
    instances.push_back(std::move(data));
  }
  return idf::encode(Dict{{"entity", snapshot.entity.to_string()},
                          {"time", to_ns(snapshot.time)},
                          {"raw_bytes", static_cast<int64_t>(snapshot.raw_bytes)},
                          {"dropped", static_cast<int64_t>(snapshot.dropped)},
                          {"dropped_bytes", static_cast<int64_t>(snapshot.dropped_bytes)},
                          {"instances", std::move(instances)}});
}

Result<FrameHead> decode_frame_head(const Buffer& payload) {
  ENGRAM_ASSIGN_OR_RETURN(const Data data, idf::decode(payload));
  return head_from_data(data);
}

Result<PackedSnapshot> decode_frame(const Buffer& payload) {
  ENGRAM_ASSIGN_OR_RETURN(const Data data, idf::decode(payload));
  ENGRAM_ASSIGN_OR_RETURN(FrameHead head, head_from_data(data));
  PackedSnapshot snapshot{std::move(head.entity), head.time,    {},
                          head.raw_bytes,         head.dropped, head.dropped_bytes};
  for (const Data& instance : data.at("instances")->get<List>()) {
    ENGRAM_ASSIGN_OR_RETURN(PackedInstance packed, instance_from_data(instance));
    snapshot.instances.push_back(std::move(packed));
  }
  return snapshot;
}

Result<Snapshot> unpack(const PackedSnapshot& packed) {
  MediumDecoder decoder;
  return unpack(packed, decoder);
}

Result<Snapshot> unpack(const PackedSnapshot& packed, MediumDecoder& decoder) {
  Snapshot snapshot{packed.entity, packed.time, {}};
  for (const PackedInstance& instance : packed.instances) {
    auto data = unpack(instance.value, decoder);
    if (!data.ok()) return data.status().with_context(snapshot.id().to_string());
    snapshot.instances.push_back({std::move(data).value(), instance.metadata});
  }
  return snapshot;
}

}  // namespace engram::ltm
