// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_snapshot.h"

#include <cmath>

#include "ltm/idf/binary.h"
#include "server/wire/wire_status.h"

namespace engram::server {

namespace {

Result<ltm::InstanceMetadata> metadata_of(v1::Instance& message) {
  ltm::InstanceMetadata metadata;
  metadata.created = time_from_ns(message.created_ns());
  metadata.sent = time_from_ns(message.sent_ns());
  metadata.arrived = time_from_ns(message.arrived_ns());
  metadata.provider = std::move(*message.mutable_provider());
  if (message.has_confidence()) metadata.confidence = message.confidence();
  metadata.recipe = std::move(*message.mutable_recipe());
  if (message.origin().empty()) return metadata;
  ENGRAM_ASSIGN_OR_RETURN(metadata.origin, ltm::MemoryId::parse(message.origin()));
  return metadata;
}

/// Appends an instance: the fields of `rest`, followed by its data. Writing the data by hand lets
/// the message share the bytes, which protobuf would copy.
void append_instance(WireWriter& writer, const v1::Instance& rest, const Buffer* data) {
  const std::string text = rest.SerializeAsString();
  const size_t data_size =
      data == nullptr ? 0 : WireWriter::field_size(v1::Instance::kDataFieldNumber, data->size());
  writer.header(v1::Snapshot::kInstancesFieldNumber, text.size() + data_size);
  writer.append(text);
  if (data != nullptr) writer.field(v1::Instance::kDataFieldNumber, *data);
}

Result<Buffer> encoded(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(auto bytes, idf::encode(data));
  return Buffer::take(std::move(bytes));
}

/// Moves the bytes out of the message, or finds them in the block.
Result<Buffer> take_bytes(v1::Instance& message, const Buffer& block) {
  if (message.has_shared()) {
    const v1::Span& span = message.shared();
    if (span.offset() > block.size() || span.size() > block.size() - span.offset())
      return invalid_argument("found {} bytes at {} of a block, which has {}", span.size(),
                              span.offset(), block.size());
    return block.slice(span.offset(), span.size());
  }
  auto owner = std::make_shared<const std::string>(std::move(*message.mutable_data()));
  const auto bytes = as_bytes(*owner);
  return Buffer(std::move(owner), bytes);
}

Result<ltm::MemoryId> entity_of(const std::string& text) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, ltm::MemoryId::parse(text));
  if (!id.is_entity()) return invalid_argument("found ID '{}', needs that of an entity", text);
  return id;
}

/// Reads an update. If `encoded` is given, it receives the bytes of each instance.
Result<ltm::Snapshot> take_update(v1::Snapshot& message, const Buffer& block,
                                  std::vector<Buffer>* encoded) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId entity, entity_of(message.entity()));
  ltm::Snapshot snapshot{std::move(entity), time_from_ns(message.time_ns()), {}};
  snapshot.instances.reserve(static_cast<size_t>(message.instances_size()));
  for (v1::Instance& instance : *message.mutable_instances()) {
    auto bytes = take_bytes(instance, block);
    if (!bytes.ok()) return bytes.status().with_context(snapshot.id().to_string());
    ltm::Instance taken;
    if (!bytes.value().empty()) {
      auto data = idf::decode(*bytes);
      if (!data.ok()) return data.status().with_context(snapshot.id().to_string());
      taken.data = *std::move(data);
    }
    ENGRAM_ASSIGN_OR_RETURN(taken.metadata, metadata_of(instance));
    snapshot.instances.push_back(std::move(taken));
    if (encoded != nullptr) encoded->push_back(*std::move(bytes));
  }
  return snapshot;
}

}  // namespace

WireBytes to_wire(const ltm::HeldSnapshot& snapshot, bool with_data) {
  WireWriter writer;
  writer.field(v1::Snapshot::kEntityFieldNumber, snapshot.entity.to_string());
  writer.field(v1::Snapshot::kTimeNsFieldNumber, static_cast<uint64_t>(to_ns(snapshot.time)));
  for (size_t i = 0; i < snapshot.instances.size(); ++i) {
    v1::Instance rest;
    rest.set_index(static_cast<int32_t>(i));
    if (!with_data) {
      append_instance(writer, rest, nullptr);
      continue;
    }
    set_metadata(rest, snapshot.instances[i].metadata);
    if (!snapshot.encoded.empty()) {
      append_instance(writer, rest, &snapshot.encoded[i]);
      continue;
    }
    // Encoding cannot fail here: what is in memory was checked on arrival and nests no deeper than
    // the binary form allows.
    const auto data = encoded(snapshot.instances[i].data);
    append_instance(writer, rest, data.ok() ? &*data : nullptr);
  }
  return writer.take();
}

WireBytes to_wire_in_block(const ltm::HeldSnapshot& snapshot, const v1::Block& block,
                           const std::vector<uint64_t>& offsets) {
  WireWriter writer;
  writer.field(v1::Snapshot::kEntityFieldNumber, snapshot.entity.to_string());
  writer.field(v1::Snapshot::kTimeNsFieldNumber, static_cast<uint64_t>(to_ns(snapshot.time)));
  writer.field(v1::Snapshot::kBlockFieldNumber, block.SerializeAsString());
  for (size_t i = 0; i < snapshot.instances.size(); ++i) {
    v1::Instance instance;
    instance.set_index(static_cast<int32_t>(i));
    set_metadata(instance, snapshot.instances[i].metadata);
    instance.mutable_shared()->set_offset(offsets[i]);
    instance.mutable_shared()->set_size(snapshot.encoded[i].size());
    append_instance(writer, instance, nullptr);
  }
  return writer.take();
}

Result<WireBytes> to_wire(const ltm::SnapshotResult& snapshot, bool with_data,
                          const std::vector<Buffer>* bytes) {
  v1::Snapshot head;
  head.set_time_ns(to_ns(snapshot.time));
  head.set_source(static_cast<v1::Source>(snapshot.source));
  head.set_model(snapshot.model);
  head.set_predictor(snapshot.predictor);
  head.set_horizon_ns(snapshot.horizon.count());
  head.set_plan(snapshot.plan);
  WireWriter writer;
  writer.append(head.SerializeAsString());
  for (size_t i = 0; i < snapshot.instances.size(); ++i) {
    const ltm::InstanceResult& instance = snapshot.instances[i];
    v1::Instance rest;
    rest.set_index(instance.index);
    if (!with_data) {
      append_instance(writer, rest, nullptr);
      continue;
    }
    set_metadata(rest, instance.metadata);
    if (instance.error) *rest.mutable_error() = to_message(*instance.error);
    if (instance.bound) *rest.mutable_bound() = to_message(*instance.bound);
    for (const ltm::MemberPrediction& member : instance.members)
      *rest.add_members() = to_message(member);
    if (bytes != nullptr) {
      append_instance(writer, rest, &(*bytes)[i]);
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(const Buffer data, encoded(instance.data));
    append_instance(writer, rest, &data);
  }
  return writer.take();
}

Result<WireCommit> take_commit(v1::CommitRequest& request, const Buffer& block) {
  WireCommit taken;
  const auto count = static_cast<size_t>(request.updates_size());
  taken.commit.updates.reserve(count);
  taken.encoded.resize(count);
  for (size_t i = 0; i < count; ++i) {
    auto update =
        take_update(*request.mutable_updates(static_cast<int>(i)), block, &taken.encoded[i]);
    if (!update.ok()) return update.status().with_context(fmt::format("update {}", i));
    taken.commit.updates.push_back(*std::move(update));
  }
  return taken;
}

Result<ltm::Snapshot> take_snapshot(v1::Snapshot& message, const Buffer& block) {
  return take_update(message, block, nullptr);
}

Result<ltm::SnapshotResult> take_answer(v1::Snapshot& message, const Buffer& block) {
  ltm::SnapshotResult answer;
  answer.time = time_from_ns(message.time_ns());
  if (message.source() < v1::RECORDED || message.source() > v1::PREDICTED)
    return data_loss("answer: found source {}, which there is not",
                     static_cast<int>(message.source()));
  answer.source = static_cast<ltm::Source>(message.source());
  answer.model = message.model();
  answer.predictor = message.predictor();
  answer.horizon = Duration(message.horizon_ns());
  answer.plan = message.plan();
  for (v1::Instance& instance : *message.mutable_instances()) {
    ENGRAM_ASSIGN_OR_RETURN(const Buffer bytes, take_bytes(instance, block));
    ltm::InstanceResult one;
    one.index = instance.index();
    if (!bytes.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(one.data, idf::decode(bytes));
      ENGRAM_ASSIGN_OR_RETURN(one.metadata, metadata_of(instance));
    }
    if (instance.has_error()) one.error = to_error(instance.error());
    if (instance.has_bound()) one.bound = to_error(instance.bound());
    for (const v1::MemberPrediction& member : instance.members())
      one.members.push_back(to_member(member));
    answer.instances.push_back(std::move(one));
  }
  return answer;
}

Result<v1::Snapshot> to_message(const ltm::Snapshot& snapshot) {
  v1::Snapshot message;
  set_head(message, snapshot);
  for (const ltm::Instance& instance : snapshot.instances) {
    v1::Instance& one = *message.add_instances();
    set_metadata(one, instance.metadata);
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(instance.data));
    one.set_data(bytes.data(), bytes.size());
  }
  return message;
}

void set_head(v1::Snapshot& message, const ltm::Snapshot& snapshot) {
  message.set_entity(snapshot.entity.to_string());
  message.set_time_ns(to_ns(snapshot.time));
}

void set_metadata(v1::Instance& message, const ltm::InstanceMetadata& metadata) {
  message.set_created_ns(to_ns(metadata.created));
  message.set_sent_ns(to_ns(metadata.sent));
  message.set_arrived_ns(to_ns(metadata.arrived));
  message.set_provider(metadata.provider);
  if (metadata.confidence != 1.0f) message.set_confidence(metadata.confidence);
  if (metadata.origin.depth() > 0) message.set_origin(metadata.origin.to_string());
  if (!metadata.recipe.empty()) message.set_recipe(metadata.recipe);
}

v1::Error to_message(const ltm::MeasuredError& error) {
  v1::Error message;
  if (!std::isnan(error.image_mse)) message.set_image_mse(error.image_mse);
  if (!std::isnan(error.number_mse)) message.set_number_mse(error.number_mse);
  return message;
}

ltm::MeasuredError to_error(const v1::Error& message) {
  ltm::MeasuredError error;
  if (message.has_image_mse()) error.image_mse = message.image_mse();
  if (message.has_number_mse()) error.number_mse = message.number_mse();
  return error;
}

v1::MemberPrediction to_message(const ltm::MemberPrediction& member) {
  v1::MemberPrediction message;
  message.set_path(member.path);
  message.set_engine(member.engine);
  if (!std::isnan(member.expected_mse)) message.set_expected_mse(member.expected_mse);
  if (!std::isnan(member.bound_mse)) message.set_bound_mse(member.bound_mse);
  message.set_copied(member.copied);
  message.set_is_image(member.is_image);
  message.set_is_moving(member.is_moving);
  message.set_is_uncounted(!member.is_counted);
  return message;
}

ltm::MemberPrediction to_member(const v1::MemberPrediction& message) {
  ltm::MemberPrediction member;
  member.path = message.path();
  member.engine = message.engine();
  if (message.has_expected_mse()) member.expected_mse = message.expected_mse();
  if (message.has_bound_mse()) member.bound_mse = message.bound_mse();
  member.copied = message.copied();
  member.is_image = message.is_image();
  member.is_moving = message.is_moving();
  member.is_counted = !message.is_uncounted();
  return member;
}

v1::Outcome to_outcome(const Status& status) {
  v1::Outcome outcome;
  outcome.set_code(static_cast<int32_t>(to_grpc_code(status.code())));
  outcome.set_message(status.message());
  return outcome;
}

Status to_status(const v1::Outcome& outcome) {
  return to_status(static_cast<grpc::StatusCode>(outcome.code()), outcome.message());
}

}  // namespace engram::server
