// SPDX-License-Identifier: Apache-2.0
#include "training/fit/checkpoint.h"

#include <array>
#include <cmath>
#include <cstring>

#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/idf/binary.h"
#include "ltm/store/checksum.h"

namespace engram::training {

namespace {

/// Must change with every change of the content of checkpoints or of the training that continues
/// from them.
constexpr std::string_view kMagic = "EGRMCKP2";
constexpr size_t kHeadBytes = kMagic.size() + sizeof(uint64_t);
/// Max size of a file, so that a hostile one cannot fill the memory.
constexpr uint64_t kMaxBytes = uint64_t{4} << 30;

idf::Data data_of(const FitStep& step) {
  return idf::Dict{{"step", step.step},
                   {"loss", step.loss},
                   {"psnr_db", step.psnr_db},
                   {"bytes", step.bytes},
                   {"price", step.price}};
}

template <typename T>
Result<T> value_at(const idf::Data& data, std::string_view key) {
  const idf::Data* found = data.at(key);
  const T* value = found == nullptr ? nullptr : found->get_if<T>();
  if (value == nullptr)
    return data_loss("member '{}': found {}, needs another", key,
                     found == nullptr ? "none" : found->kind_name());
  return *value;
}

Result<double> finite_at(const idf::Data& data, std::string_view key) {
  ENGRAM_ASSIGN_OR_RETURN(const double value, value_at<double>(data, key));
  if (!std::isfinite(value)) return data_loss("member '{}': found {}", key, value);
  return value;
}

Result<FitStep> step_at(const idf::Data& data, std::string_view key) {
  ENGRAM_ASSIGN_OR_RETURN(const auto kept, value_at<idf::Dict>(data, key));
  FitStep step;
  ENGRAM_ASSIGN_OR_RETURN(step.step, value_at<int64_t>(kept, "step"));
  ENGRAM_ASSIGN_OR_RETURN(step.loss, value_at<double>(kept, "loss"));
  ENGRAM_ASSIGN_OR_RETURN(step.psnr_db, value_at<double>(kept, "psnr_db"));
  ENGRAM_ASSIGN_OR_RETURN(step.bytes, value_at<double>(kept, "bytes"));
  ENGRAM_ASSIGN_OR_RETURN(step.price, value_at<double>(kept, "price"));
  return step;
}

idf::Data data_of(const std::vector<encoders::CurvePoint>& curve) {
  idf::List points;
  for (const encoders::CurvePoint& point : curve)
    points.emplace_back(idf::Dict{{"phase", point.phase},
                                  {"step", point.step},
                                  {"seconds", point.seconds},
                                  {"loss", point.loss},
                                  {"psnr_db", point.psnr_db},
                                  {"bytes", point.bytes}});
  return points;
}

Result<std::vector<encoders::CurvePoint>> curve_at(const idf::Data& data, std::string_view key) {
  ENGRAM_ASSIGN_OR_RETURN(const auto kept, value_at<idf::List>(data, key));
  std::vector<encoders::CurvePoint> curve;
  for (const idf::Data& one : kept) {
    encoders::CurvePoint& point = curve.emplace_back();
    ENGRAM_ASSIGN_OR_RETURN(point.phase, value_at<int32_t>(one, "phase"));
    ENGRAM_ASSIGN_OR_RETURN(point.step, value_at<int64_t>(one, "step"));
    ENGRAM_ASSIGN_OR_RETURN(point.seconds, value_at<float>(one, "seconds"));
    ENGRAM_ASSIGN_OR_RETURN(point.loss, value_at<float>(one, "loss"));
    ENGRAM_ASSIGN_OR_RETURN(point.psnr_db, value_at<float>(one, "psnr_db"));
    ENGRAM_ASSIGN_OR_RETURN(point.bytes, value_at<float>(one, "bytes"));
  }
  return curve;
}

Result<Checkpoint> checkpoint_of(const idf::Data& data, uint64_t key) {
  ENGRAM_ASSIGN_OR_RETURN(const auto found, value_at<int64_t>(data, "key"));
  if (static_cast<uint64_t>(found) != key)
    return failed_precondition("is of other options or other data");
  Checkpoint checkpoint;
  ENGRAM_ASSIGN_OR_RETURN(const auto phase, value_at<int32_t>(data, "phase"));
  if (phase < static_cast<int32_t>(FitPhase::kAutoencoder) ||
      phase > static_cast<int32_t>(FitPhase::kMotion))
    return data_loss("phase: found {}", phase);
  checkpoint.phase = static_cast<FitPhase>(phase);
  ENGRAM_ASSIGN_OR_RETURN(checkpoint.share, finite_at(data, "share"));
  ENGRAM_ASSIGN_OR_RETURN(checkpoint.seconds, finite_at(data, "seconds"));
  if (checkpoint.share < 0) return data_loss("share: found {}", checkpoint.share);
  ENGRAM_ASSIGN_OR_RETURN(checkpoint.coded, step_at(data, "coded"));
  ENGRAM_ASSIGN_OR_RETURN(checkpoint.predicted, step_at(data, "predicted"));
  ENGRAM_ASSIGN_OR_RETURN(idf::Dict state, value_at<idf::Dict>(data, "state"));
  checkpoint.state = std::move(state);
  ENGRAM_ASSIGN_OR_RETURN(checkpoint.curve, curve_at(data, "curve"));
  return checkpoint;
}

}  // namespace

std::string_view name_of(FitPhase phase) {
  constexpr std::array<std::string_view, 3> kNames{"autoencoder", "dynamics", "motion"};
  return kNames[static_cast<size_t>(phase)];
}

uint64_t checkpoint_key(const TrainingSource& source, const TrainOptions& o) {
  // A fixed number of steps promises the same model, which depends on the threads. A training by
  // time may continue with other threads.
  const int threads = o.steps ? o.threads : 0;
  std::string text =
      fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}", kMagic, source.entity,
                  source.condition_entity, static_cast<int>(o.variant), o.steps.value_or(0), o.seed,
                  o.batch_size, o.psnr_db, o.number_bound.value_or(-1), o.has_networks, o.width,
                  o.coarse_channels, o.fine_channels, o.chain_rows, o.varied_share, threads,
                  o.memory_bytes, o.hold_out_recordings, source.times.size());
  for (const Time time : source.times) text += fmt::format(" {}", to_ns(time));
  if (source.previous)
    text += fmt::format(" v{} {}", source.previous->version, source.previous->checksum);
  if (source.augmented)
    text += fmt::format(" augmented {} {}", source.augmented->identity, o.augmented_share);
  for (const bool is_known : source.is_known) text += is_known ? " 1" : " 0";
  return ltm::checksum(as_bytes(text));
}

Status write_checkpoint(const std::filesystem::path& file, uint64_t key,
                        const Checkpoint& checkpoint) {
  ENGRAM_ASSIGN_OR_RETURN(const auto body,
                          idf::encode(idf::Dict{{"key", static_cast<int64_t>(key)},
                                                {"phase", static_cast<int32_t>(checkpoint.phase)},
                                                {"share", checkpoint.share},
                                                {"seconds", checkpoint.seconds},
                                                {"coded", data_of(checkpoint.coded)},
                                                {"predicted", data_of(checkpoint.predicted)},
                                                {"state", checkpoint.state},
                                                {"curve", data_of(checkpoint.curve)}}));
  std::vector<std::byte> bytes(kHeadBytes);
  const uint64_t sum = ltm::checksum(body);
  std::memcpy(bytes.data(), kMagic.data(), kMagic.size());
  std::memcpy(bytes.data() + kMagic.size(), &sum, sizeof(sum));
  bytes.insert(bytes.end(), body.begin(), body.end());
  ENGRAM_RETURN_IF_ERROR(make_directories(file.parent_path()));
  return replace_file(file, bytes);
}

Result<Checkpoint> read_checkpoint(const std::filesystem::path& file, uint64_t key) {
  Buffer bytes;
  {
    ENGRAM_ASSIGN_OR_RETURN(const File in, File::open(file, File::Mode::kRead));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, in.size());
    if (size < kHeadBytes || size > kMaxBytes)
      return data_loss("checkpoint '{}': found {} bytes, needs {} to {}", file.string(), size,
                       kHeadBytes, kMaxBytes);
    ENGRAM_ASSIGN_OR_RETURN(bytes, read_file(file));
  }
  uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + kMagic.size(), sizeof(sum));
  const Buffer body = bytes.slice(kHeadBytes, bytes.size() - kHeadBytes);
  if (as_text(bytes.bytes().first(kMagic.size())) != kMagic)
    return data_loss("checkpoint '{}': does not begin with '{}'", file.string(), kMagic);
  if (ltm::checksum(body.bytes()) != sum)
    return data_loss("checkpoint '{}': its checksum does not fit", file.string());
  const auto context = fmt::format("checkpoint '{}'", file.string());
  const auto data = idf::decode(body);
  if (!data.ok()) return data.status().with_context(context);
  auto checkpoint = checkpoint_of(*data, key);
  if (!checkpoint.ok()) return checkpoint.status().with_context(context);
  return checkpoint;
}

Checkpoints::Checkpoints(std::filesystem::path file, uint64_t key, Duration interval)
    : file_(std::move(file)), key_(key), interval_(interval) {
  if (file_.empty()) return;
  auto found = read_checkpoint(file_, key_);
  if (found.ok()) {
    found_ = *std::move(found);
    curve = encoders::TrainingCurve(found_->curve);
  } else if (found.status().code() != StatusCode::kNotFound)
    log::warning("{}: training starts anew", found.status().message());
}

void Checkpoints::refuse_found(const Status& why) {
  log::warning("checkpoint '{}': {}: training starts anew", file_.string(), why.message());
  found_.reset();
  curve = {};
  has_refused_ = true;
}

bool Checkpoints::is_due() const {
  return is_on() && std::chrono::steady_clock::now() - last_ >= interval_;
}

void Checkpoints::save(Checkpoint checkpoint) {
  if (!is_on()) return;
  checkpoint.seconds = seconds();
  checkpoint.coded = coded;
  checkpoint.predicted = predicted;
  checkpoint.curve = curve.points();
  const Status written = write_checkpoint(file_, key_, checkpoint);
  last_ = std::chrono::steady_clock::now();
  if (!written.ok() && !has_warned_)
    log::warning("training goes on without a checkpoint: {}", written.message());
  has_warned_ = !written.ok();
}

double Checkpoints::seconds() const {
  const double now = to_seconds(std::chrono::steady_clock::now() - start_) - idle_seconds_;
  return now + (found_ ? found_->seconds : 0);
}

}  // namespace engram::training
