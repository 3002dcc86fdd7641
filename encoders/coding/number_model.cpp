// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/number_model.h"

#include <algorithm>
#include <cmath>

#include "encoders/coding/byte_stream.h"
#include "encoders/coding/checked_block.h"

namespace engram::encoders {

namespace {

constexpr uint8_t kVersion = 1;

size_t channels_of(const NumberField& field) {
  return field.kind == NumberKind::kOrientation ? 3 : field.count;
}

Status check_field(const NumberField& field, size_t index) {
  if (is_exact(field.kind)) return {};
  const bool is_orientation = field.kind == NumberKind::kOrientation;
  if (is_orientation && field.count != 4)
    return invalid_argument("number field {}: an orientation of {} numbers, needs 4", index,
                            field.count);
  const double min = is_orientation ? 1e-9 : 1e-150, max = is_orientation ? 1.0 : 1e150;
  if (!(field.bound >= min && field.bound <= max))
    return invalid_argument("number field {}: bound {}, needs {} to {}", index, field.bound, min,
                            max);
  return {};
}

Status check_fields(const std::vector<NumberField>& fields) {
  size_t count = 0;
  for (size_t i = 0; i < fields.size(); ++i) {
    ENGRAM_RETURN_IF_ERROR(check_field(fields[i], i));
    count += fields[i].count;
    if (fields[i].count == 0 || count > NumberModel::kMaxNumbers)
      return invalid_argument("number field {}: {} numbers in all, needs 1 to {}", i, count,
                              NumberModel::kMaxNumbers);
  }
  return {};
}

void write_channel(ByteWriter& out, const NumberChannel& channel) {
  out.put(static_cast<uint8_t>(channel.decimals | channel.eighths << 4));
  out.put_varint(channel.start);
  out.put<int8_t>(channel.start_scale);
  out.put<int8_t>(channel.usual_scale);
  for (const int8_t bias : channel.scale_bias) out.put<int8_t>(bias);
  out.put<uint8_t>(static_cast<uint8_t>(channel.terms.size()));
  for (const PredictorTerm& term : channel.terms) {
    out.put_varint(static_cast<int64_t>(term.channel) * int64_t{kFeatureKinds} +
                   static_cast<int64_t>(term.kind));
    out.put<int16_t>(term.weight);
  }
}

NumberChannel read_channel(ByteReader& in) {
  NumberChannel channel;
  const auto setting = in.get<uint8_t>();
  channel.decimals = setting & 15;
  channel.eighths = std::min<uint8_t>(setting >> 4, 8);
  channel.start = std::clamp<int64_t>(in.get_varint(), -(int64_t{1} << 40), int64_t{1} << 40);
  channel.start_scale = in.get<int8_t>();
  channel.usual_scale = in.get<int8_t>();
  for (int8_t& bias : channel.scale_bias) bias = in.get<int8_t>();
  channel.terms.resize(std::min<size_t>(in.get<uint8_t>(), NumberChannel::kMaxTerms));
  for (PredictorTerm& term : channel.terms) {
    const auto code = static_cast<uint64_t>(in.get_varint());
    term.kind = static_cast<FeatureKind>(code % kFeatureKinds);
    term.channel =
        static_cast<uint16_t>(std::min<uint64_t>(code / kFeatureKinds, NumberModel::kMaxNumbers));
    term.weight = in.get<int16_t>();
  }
  return channel;
}

/// Whether all terms of a channel use only values that are decoded before it.
bool are_terms_known(const NumberModel& model, size_t at) {
  return std::ranges::all_of(model.channels[at].terms, [&](const PredictorTerm& term) {
    const bool is_now = term.kind == FeatureKind::kChangeNow || term.kind == FeatureKind::kLevelNow;
    return term.channel < (is_now ? at : model.channels.size());
  });
}

template <typename Visit>
void for_each_start(NumberModel& model, Visit visit) {
  for (int16_t& weight : model.scale_weights) visit(weight);
  for (int8_t& odds : model.scale_starts) visit(odds);
  for (int8_t& odds : model.hold_starts) visit(odds);
  for (int8_t& odds : model.channel_starts) visit(odds);
  for (auto& sets : model.mixers)
    for (auto& weights : sets)
      for (int16_t& weight : weights) visit(weight);
}

Result<std::vector<NumberField>> read_fields(ByteReader& in) {
  std::vector<NumberField> fields(std::min<size_t>(in.get<uint16_t>(), NumberModel::kMaxNumbers));
  for (NumberField& field : fields) {
    const auto kind = in.get<uint8_t>();
    if (kind > static_cast<uint8_t>(NumberKind::kExactFloat))
      return data_loss("number model: field of unknown kind {}", kind);
    field.kind = static_cast<NumberKind>(kind);
    field.count = static_cast<uint32_t>(
        std::clamp<int64_t>(in.get_varint(), 0, NumberModel::kMaxNumbers + 1));
    field.bound = in.get<double>();
  }
  if (in.failed()) return data_loss("number model: ends in its fields");
  return fields;
}

}  // namespace

std::vector<NumberField> number_fields(const idf::Layout& layout, double bound,
                                       double orientation_bound_rad) {
  std::vector<NumberField> fields;
  for (const idf::TensorMember& member : layout.members()) {
    if (member.kind == idf::MemberKind::kImage) continue;
    NumberField field;
    int64_t count = 1;
    for (const int64_t size : member.shape)
      count = std::min<int64_t>(count * size, NumberModel::kMaxNumbers + 1);
    field.count = static_cast<uint32_t>(count);
    const bool is_real =
        member.type == idf::ElementType::kFloat32 || member.type == idf::ElementType::kFloat64;
    field.bound = bound;
    if (member.kind == idf::MemberKind::kOrientation && orientation_bound_rad > 0)
      field = {NumberKind::kOrientation, 4, orientation_bound_rad};
    else if (!is_real || bound <= 0)
      field.kind =
          member.type == idf::ElementType::kFloat32 ? NumberKind::kExactFloat : NumberKind::kExact;
    if (field.count > 0) fields.push_back(field);
  }
  return fields;
}

Result<NumberModel> NumberModel::create(std::vector<NumberField> fields) {
  ENGRAM_RETURN_IF_ERROR(check_fields(fields));
  NumberModel model;
  model.fields = std::move(fields);
  size_t channels = 0;
  for (const NumberField& field : model.fields) channels += channels_of(field);
  model.channels.resize(channels);
  model.channel_starts.resize(channels * kChannelNodes);
  for (NumberChannel& channel : model.channels) channel.start_scale = channel.usual_scale = 16;
  for (auto& sets : model.mixers)
    // The first prediction starts with a weight of 1/4, the others and the contexts with 1/8.
    for (auto& weights : sets) weights = {1024, 512, 512, 512, 512, 512, 512, 0};
  return model;
}

size_t NumberModel::count() const {
  size_t count = 0;
  for (const NumberField& field : fields) count += field.count;
  return count;
}

std::vector<std::byte> NumberModel::to_bytes() const {
  ByteWriter out;
  out.put<uint8_t>(kVersion);
  out.put<uint16_t>(static_cast<uint16_t>(fields.size()));
  for (const NumberField& field : fields) {
    out.put<uint8_t>(static_cast<uint8_t>(field.kind));
    out.put_varint(field.count);
    out.put<double>(field.bound);
  }
  for (const NumberChannel& channel : channels) write_channel(out, channel);
  NumberModel copy = *this;
  for_each_start(copy, [&](auto value) { out.put(value); });
  return with_checksum(out.take());
}

Result<NumberModel> NumberModel::from_bytes(std::span<const std::byte> bytes) {
  ENGRAM_ASSIGN_OR_RETURN(const auto body, without_checksum(bytes, "number model"));
  ByteReader in(body);
  if (const auto version = in.get<uint8_t>(); version != kVersion)
    return failed_precondition("number model: version {}, needs {}", version, kVersion);
  ENGRAM_ASSIGN_OR_RETURN(auto fields, read_fields(in));
  auto created = NumberModel::create(std::move(fields));
  // Fields that create() refuses are damage here, because a writer cannot have made such a model.
  if (!created.ok()) return data_loss("{}", created.status().message());
  NumberModel model = std::move(created).value();
  for (NumberChannel& channel : model.channels) channel = read_channel(in);
  for_each_start(model, [&](auto& value) { value = in.get<std::decay_t<decltype(value)>>(); });
  for (size_t i = 0; i < model.channels.size(); ++i)
    if (!are_terms_known(model, i))
      return data_loss("number model: channel {} is predicted by what comes later", i);
  if (in.failed() || !in.is_at_end())
    return data_loss("number model: {} bytes do not hold what they announce", bytes.size());
  return model;
}

}  // namespace engram::encoders
