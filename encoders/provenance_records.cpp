// SPDX-License-Identifier: Apache-2.0
#include "encoders/provenance_records.h"

#include <string_view>

#include "encoders/model_vectors.h"

namespace engram::encoders {

namespace {

Status write_spans(h5::File& file, const std::string& path, const std::vector<TimeSpan>& spans) {
  std::vector<int64_t> ends;
  for (const TimeSpan& span : spans) {
    ends.push_back(to_ns(span.first));
    ends.push_back(to_ns(span.last));
  }
  return write_vector(file, path, ends);
}

Result<std::vector<TimeSpan>> read_spans(const h5::File& file, const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(const auto ends, read_vector<int64_t>(file, path));
  std::vector<TimeSpan> spans;
  for (size_t i = 0; i + 1 < ends.size(); i += 2)
    spans.push_back({time_from_ns(ends[i]), time_from_ns(ends[i + 1])});
  return spans;
}

constexpr const char* kCurve = "/provenance/curve";
/// Number of columns of the curve: phase, step, seconds, loss, PSNR in dB, bytes.
constexpr size_t kCurveColumns = 6;

Status write_curve(h5::File& file, const std::vector<CurvePoint>& curve) {
  std::vector<float> rows;
  for (const CurvePoint& point : curve)
    rows.insert(rows.end(), {static_cast<float>(point.phase), static_cast<float>(point.step),
                             point.seconds, point.loss, point.psnr_db, point.bytes});
  return write_vector(file, kCurve, rows);
}

/// The result is empty if the file has none.
Result<std::vector<CurvePoint>> read_curve(const h5::File& file) {
  std::vector<CurvePoint> curve;
  ENGRAM_ASSIGN_OR_RETURN(const bool is_there, file.exists(kCurve));
  if (!is_there) return curve;
  ENGRAM_ASSIGN_OR_RETURN(const auto rows, read_vector<float>(file, kCurve));
  constexpr float kMaxSteps = 1e15f;
  const auto is_number = [](float x) { return x >= 0 && x <= kMaxSteps; };
  for (size_t i = 0; i + kCurveColumns <= rows.size(); i += kCurveColumns) {
    if (!is_number(rows[i]) || !is_number(rows[i + 1]) || rows[i] > 2)
      return data_loss("'{}': found phase {} and step {}", kCurve, rows[i], rows[i + 1]);
    curve.push_back({static_cast<int32_t>(rows[i]), static_cast<int64_t>(rows[i + 1]), rows[i + 2],
                     rows[i + 3], rows[i + 4], rows[i + 5]});
  }
  return curve;
}

constexpr const char* kForms = "/provenance/forms";

/// Visits the integers of StoredForms by name.
template <typename Forms, typename Visit>
Status for_each_count(Forms& forms, Visit visit) {
  ENGRAM_RETURN_IF_ERROR(visit("noise_images", forms.noise_images));
  ENGRAM_RETURN_IF_ERROR(visit("rows", forms.rows));
  ENGRAM_RETURN_IF_ERROR(visit("latent_rows", forms.latent_rows));
  ENGRAM_RETURN_IF_ERROR(visit("refined_rows", forms.refined_rows));
  ENGRAM_RETURN_IF_ERROR(visit("residual_rows", forms.residual_rows));
  ENGRAM_RETURN_IF_ERROR(visit("video_rows", forms.video_rows));
  ENGRAM_RETURN_IF_ERROR(visit("lossless_rows", forms.lossless_rows));
  ENGRAM_RETURN_IF_ERROR(visit("kept_bytes", forms.kept_bytes));
  ENGRAM_RETURN_IF_ERROR(visit("latent_kept_bytes", forms.latent_kept_bytes));
  ENGRAM_RETURN_IF_ERROR(visit("refined_kept_bytes", forms.refined_kept_bytes));
  ENGRAM_RETURN_IF_ERROR(visit("residual_kept_bytes", forms.residual_kept_bytes));
  ENGRAM_RETURN_IF_ERROR(visit("video_kept_bytes", forms.video_kept_bytes));
  ENGRAM_RETURN_IF_ERROR(visit("lossless_kept_bytes", forms.lossless_kept_bytes));
  ENGRAM_RETURN_IF_ERROR(visit("below_bound_rows", forms.below_bound_rows));
  ENGRAM_RETURN_IF_ERROR(visit("refine_tried_rows", forms.refine_tried_rows));
  ENGRAM_RETURN_IF_ERROR(visit("latent_bytes", forms.latent_bytes));
  ENGRAM_RETURN_IF_ERROR(visit("residual_bytes", forms.residual_bytes));
  ENGRAM_RETURN_IF_ERROR(visit("video_bytes", forms.video_bytes));
  return visit("lossless_bytes", forms.lossless_bytes);
}

Status write_forms(h5::File& file, const StoredForms& forms) {
  ENGRAM_RETURN_IF_ERROR(file.make_group(kForms));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute(kForms, "representation", std::string_view(forms.representation)));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kForms, "bound_db", forms.bound_db));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(kForms, "noise", forms.noise));
  return for_each_count(forms, [&](const char* name, int64_t count) {
    return file.write_attribute(kForms, name, count);
  });
}

constexpr const char* kChoice = "/provenance/choice";

/// Visits the integers of ModelChoice by name.
template <typename Choice, typename Visit>
Status for_each_choice(Choice& choice, Visit visit) {
  ENGRAM_RETURN_IF_ERROR(visit("previous_version", choice.previous_version));
  ENGRAM_RETURN_IF_ERROR(visit("snapshots", choice.snapshots));
  ENGRAM_RETURN_IF_ERROR(visit("new_snapshots", choice.new_snapshots));
  ENGRAM_RETURN_IF_ERROR(visit("nights", choice.nights));
  ENGRAM_RETURN_IF_ERROR(visit("previous_known_bytes", choice.previous.known));
  ENGRAM_RETURN_IF_ERROR(visit("previous_new_bytes", choice.previous.news));
  ENGRAM_RETURN_IF_ERROR(visit("previous_model_bytes", choice.previous.model));
  ENGRAM_RETURN_IF_ERROR(visit("made_known_bytes", choice.made.known));
  ENGRAM_RETURN_IF_ERROR(visit("made_new_bytes", choice.made.news));
  return visit("made_model_bytes", choice.made.model);
}

Status write_choice(h5::File& file, const ModelChoice& choice) {
  ENGRAM_RETURN_IF_ERROR(file.make_group(kChoice));
  return for_each_choice(choice, [&](const char* name, int64_t count) {
    return file.write_attribute(kChoice, name, count);
  });
}

Result<ModelChoice> read_choice(const h5::File& file) {
  ModelChoice choice;
  ENGRAM_RETURN_IF_ERROR(for_each_choice(choice, [&](const char* name, int64_t& count) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(count, file.int_attribute(kChoice, name));
    if (count < 0) return data_loss("choice: found {} of {}, needs 0 or more", count, name);
    return {};
  }));
  if (choice.new_snapshots > choice.snapshots)
    return data_loss("choice: found {} new ones among {} snapshots", choice.new_snapshots,
                     choice.snapshots);
  return choice;
}

Result<TrainingVariant> read_variant(const h5::File& file, const std::string& group) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string name, file.string_attribute(group, "variant"));
  const auto variant = training_variant_of(name);
  if (!variant.ok()) return data_loss("{}", variant.status().message());
  return *variant;
}

Result<StoredForms> read_forms(const h5::File& file) {
  StoredForms forms;
  ENGRAM_ASSIGN_OR_RETURN(forms.representation, file.string_attribute(kForms, "representation"));
  ENGRAM_ASSIGN_OR_RETURN(forms.bound_db, file.double_attribute(kForms, "bound_db"));
  ENGRAM_ASSIGN_OR_RETURN(forms.noise, file.double_attribute(kForms, "noise"));
  ENGRAM_RETURN_IF_ERROR(for_each_count(forms, [&](const char* name, int64_t& count) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(count, file.int_attribute(kForms, name));
    return {};
  }));
  return forms;
}

/// A bound of zero means that none was given, unless the file says that numbers are exact. Earlier
/// files could not say so.
Result<std::optional<double>> read_number_bound(const h5::File& file, const std::string& group) {
  ENGRAM_ASSIGN_OR_RETURN(const double bound, file.double_attribute(group, "number_bound"));
  const bool is_exact = file.int_attribute(group, "has_exact_numbers").value_or(0) != 0;
  if (bound > 0 || is_exact) return std::optional(is_exact ? 0.0 : bound);
  return std::optional<double>();
}

}  // namespace

Status replace_choice(h5::File& file, const ModelChoice& choice) {
  return for_each_choice(choice, [&](const char* name, int64_t count) {
    return file.replace_attribute(kChoice, name, count);
  });
}

Status write_provenance(h5::File& file, const Provenance& from) {
  ENGRAM_RETURN_IF_ERROR(file.make_group("/provenance"));
  const std::string group = "/provenance";
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "entity", std::string_view(from.entity)));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute(group, "code_version", std::string_view(from.code_version)));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "seed", static_cast<int64_t>(from.seed)));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "variant", to_string(from.variant)));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "steps", from.steps));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "training_seconds", from.training_seconds));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "final_loss", from.final_loss));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "psnr_db", from.psnr_db));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute(group, "number_bound", from.number_bound.value_or(0.0)));
  ENGRAM_RETURN_IF_ERROR(
      file.write_attribute(group, "has_exact_numbers", int64_t{from.number_bound == 0.0 ? 1 : 0}));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "error_price", from.error_price));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "prior_bytes", from.prior_bytes));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "snapshots", from.snapshots));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "started_from", from.started_from));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute(group, "forgotten", from.forgotten));
  ENGRAM_RETURN_IF_ERROR(write_forms(file, from.forms));
  ENGRAM_RETURN_IF_ERROR(write_choice(file, from.choice));
  ENGRAM_RETURN_IF_ERROR(write_spans(file, group + "/autoencoder_spans", from.autoencoder_spans));
  ENGRAM_RETURN_IF_ERROR(write_spans(file, group + "/dynamics_spans", from.dynamics_spans));
  return write_curve(file, from.curve);
}

Result<Provenance> read_provenance(const h5::File& file) {
  const std::string group = "/provenance";
  Provenance from;
  ENGRAM_ASSIGN_OR_RETURN(from.entity, file.string_attribute(group, "entity"));
  ENGRAM_ASSIGN_OR_RETURN(from.code_version, file.string_attribute(group, "code_version"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t seed, file.int_attribute(group, "seed"));
  from.seed = static_cast<uint64_t>(seed);
  ENGRAM_ASSIGN_OR_RETURN(from.variant, read_variant(file, group));
  ENGRAM_ASSIGN_OR_RETURN(from.steps, file.int_attribute(group, "steps"));
  ENGRAM_ASSIGN_OR_RETURN(from.training_seconds, file.double_attribute(group, "training_seconds"));
  ENGRAM_ASSIGN_OR_RETURN(from.final_loss, file.double_attribute(group, "final_loss"));
  ENGRAM_ASSIGN_OR_RETURN(from.psnr_db, file.double_attribute(group, "psnr_db"));
  ENGRAM_ASSIGN_OR_RETURN(from.number_bound, read_number_bound(file, group));
  ENGRAM_ASSIGN_OR_RETURN(from.error_price, file.double_attribute(group, "error_price"));
  ENGRAM_ASSIGN_OR_RETURN(from.prior_bytes, file.double_attribute(group, "prior_bytes"));
  ENGRAM_ASSIGN_OR_RETURN(from.snapshots, file.int_attribute(group, "snapshots"));
  ENGRAM_ASSIGN_OR_RETURN(from.started_from, file.int_attribute(group, "started_from"));
  if (const auto forgotten = file.int_attribute(group, "forgotten"); forgotten.ok())
    from.forgotten = *forgotten;
  ENGRAM_ASSIGN_OR_RETURN(from.forms, read_forms(file));
  ENGRAM_ASSIGN_OR_RETURN(from.choice, read_choice(file));
  ENGRAM_ASSIGN_OR_RETURN(from.autoencoder_spans, read_spans(file, group + "/autoencoder_spans"));
  ENGRAM_ASSIGN_OR_RETURN(from.dynamics_spans, read_spans(file, group + "/dynamics_spans"));
  ENGRAM_ASSIGN_OR_RETURN(from.curve, read_curve(file));
  return from;
}

}  // namespace engram::encoders
