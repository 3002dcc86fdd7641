// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_similar.h"

#include "ltm/idf/binary.h"

namespace engram::server {

namespace {

Result<ltm::MemoryId> entity_in(const std::string& text) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, ltm::MemoryId::parse(text));
  if (!id.is_entity()) return invalid_argument("found ID '{}', needs that of an entity", text);
  return id;
}

Result<idf::NdArray> image_in(const std::string& bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data data, idf::decode(Buffer::copy(as_bytes(bytes))));
  if (const auto* array = data.get_if<idf::NdArray>()) return *array;
  return invalid_argument("found a value that is no array, needs an image");
}

}  // namespace

Result<v1::SimilarRequest> to_message(const ltm::SimilarRequest& request) {
  ENGRAM_RETURN_IF_ERROR(request.validate());
  v1::SimilarRequest message;
  message.set_entity(request.entity.to_string());
  if (request.moment) message.set_moment_ns(to_ns(*request.moment));
  if (request.image) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, idf::encode(idf::Data(*request.image)));
    message.set_image(bytes.data(), bytes.size());
  }
  for (const ltm::SimilarPart& part : request.with) {
    v1::SimilarRequest::Part& one = *message.add_with();
    one.set_entity(part.entity.to_string());
    one.set_weight(part.weight);
  }
  if (request.among) message.set_among(request.among->to_string());
  message.set_count(request.count);
  message.set_apart_ns(request.apart.count());
  message.set_context_ns(request.context.count());
  message.set_is_one_per_recording(request.is_one_per_recording);
  message.set_is_elsewhere(request.is_elsewhere);
  message.set_takes_any_size(request.takes_any_size);
  return message;
}

Result<ltm::SimilarRequest> to_request(const v1::SimilarRequest& message) {
  ltm::SimilarRequest request;
  ENGRAM_ASSIGN_OR_RETURN(request.entity, entity_in(message.entity()));
  if (message.has_moment_ns()) request.moment = time_from_ns(message.moment_ns());
  if (!message.image().empty()) {
    ENGRAM_ASSIGN_OR_RETURN(request.image, image_in(message.image()));
  }
  if (message.with_size() > kMaxSimilarParts)
    return invalid_argument("found {} other entities to compare, needs at most {}",
                            message.with_size(), kMaxSimilarParts);
  for (const v1::SimilarRequest::Part& part : message.with()) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId entity, entity_in(part.entity()));
    request.with.push_back({std::move(entity), part.weight()});
  }
  if (!message.among().empty()) {
    ENGRAM_ASSIGN_OR_RETURN(request.among, ltm::Query::parse(message.among()));
  }
  if (message.count() > kMaxSimilarMoments)
    return invalid_argument("found a count of {} moments, needs at most {}", message.count(),
                            kMaxSimilarMoments);
  request.count = message.count();
  request.apart = Duration(message.apart_ns());
  request.context = Duration(message.context_ns());
  request.is_one_per_recording = message.is_one_per_recording();
  request.is_elsewhere = message.is_elsewhere();
  request.takes_any_size = message.takes_any_size();
  ENGRAM_RETURN_IF_ERROR(request.validate());
  return request;
}

v1::SimilarReply to_message(const ltm::SimilarAnswer& answer) {
  v1::SimilarReply message;
  message.set_space(answer.space);
  message.set_is_stored_space(answer.is_stored_space);
  message.set_compared(answer.compared);
  message.set_computed(answer.computed);
  for (const ltm::SimilarMoment& moment : answer.moments) {
    v1::SimilarReply::Moment& one = *message.add_moments();
    one.set_time_ns(to_ns(moment.time));
    one.set_distance(moment.distance);
    one.set_recording_first_ns(to_ns(moment.recording_first));
    one.set_recording_last_ns(to_ns(moment.recording_last));
  }
  return message;
}

ltm::SimilarAnswer to_answer(const v1::SimilarReply& message, const ltm::MemoryId& entity) {
  ltm::SimilarAnswer answer{
      entity, message.space(), message.is_stored_space(), message.compared(), message.computed(),
      {}};
  for (const v1::SimilarReply::Moment& moment : message.moments())
    answer.moments.push_back({time_from_ns(moment.time_ns()), moment.distance(),
                              time_from_ns(moment.recording_first_ns()),
                              time_from_ns(moment.recording_last_ns())});
  return answer;
}

}  // namespace engram::server
