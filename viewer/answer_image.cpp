// SPDX-License-Identifier: Apache-2.0
// Images as they were recorded, as latents and predictions have them, and how wrong these are.
#include <cmath>

#include "ltm/core/buffer.h"
#include "ltm/store/checksum.h"
#include "reports/plain/shown_image.h"
#include "reports/plain/shown_value.h"
#include "training/quality/quality_metrics.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

/// An image and the snapshot that it is of.
struct FoundImage {
  ltm::SnapshotResult snapshot;
  idf::NdArray image;
};

Result<FoundImage> image_in(ltm::SnapshotResult snapshot, const ltm::MemoryId& id,
                            const std::string& path) {
  const ltm::InstanceResult* instance = snapshot.find(id.index().value_or(0));
  if (instance == nullptr)
    return not_found("'{}': there is no instance {}", id.to_string(), id.index().value_or(0));
  const idf::NdArray* image = reports::image_at(instance->data, path);
  if (image == nullptr) return not_found("'{}': has no image at '{}'", id.to_string(), path);
  idf::NdArray pixels = *image;
  return FoundImage{std::move(snapshot), std::move(pixels)};
}

Result<FoundImage> recalled_image(Memory& memory, const ltm::MemoryId& id,
                                  const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(auto found, find_one(memory, id.entity(), ltm::select::At{*id.time()}));
  if (!found || found->source == ltm::Source::kPredicted)
    return not_found("'{}': there is no such snapshot", id.to_string());
  return image_in(*std::move(found), id, path);
}

Result<FoundImage> predicted_image(ViewedMemory& viewed, const RequestTarget& target,
                                   const ltm::MemoryId& id, const std::string& path) {
  PredictOptions options;
  if (target.find("from")) {
    ENGRAM_ASSIGN_OR_RETURN(options.at, target.time("from"));
  }
  ENGRAM_ASSIGN_OR_RETURN(const int64_t horizon,
                          target.integer("horizon", 1, Duration::max().count()));
  const Duration ahead(horizon);
  ENGRAM_ASSIGN_OR_RETURN(Memory * memory, viewed.for_long_questions());
  ENGRAM_ASSIGN_OR_RETURN(auto found, memory->predict(id.entity(), {&ahead, 1}, options));
  if (found.empty()) return not_found("'{}': nothing was predicted", id.to_string());
  return image_in(std::move(found.front()), id, path);
}

Result<FoundImage> latent_image(ViewedMemory& viewed, const ltm::MemoryId& id,
                                const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(Memory * latents, viewed.latents());
  ENGRAM_ASSIGN_OR_RETURN(FoundImage found, recalled_image(*latents, id, path));
  if (found.snapshot.source != ltm::Source::kReconstructed)
    return not_found("'{}': has no latents", id.to_string());
  return found;
}

Result<FoundImage> recorded_image(ViewedMemory& viewed, const ltm::MemoryId& id,
                                  const std::string& path) {
  ENGRAM_ASSIGN_OR_RETURN(FoundImage found, recalled_image(viewed.memory(), id, path));
  if (found.snapshot.source == ltm::Source::kReconstructed)
    return not_found("'{}': its recorded form is gone", id.to_string());
  return found;
}

/// How much an image takes in the store in recorded form; nothing if that is not known, or if it is
/// stored together with others.
std::optional<uint64_t> stored_bytes_of(ViewedMemory& viewed, const ltm::MemoryId& id,
                                        const std::string& path) {
  std::optional<uint64_t> bytes;
  const Status status = viewed.with_store([&](const StoreView& view) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, view.reader.timeline(id.entity()));
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(*id.time()));
    if (!entry || entry->time != *id.time() || !entry->recorded) return {};
    ENGRAM_ASSIGN_OR_RETURN(const auto packed, view.reader.read_packed(id.entity(), *entry));
    const auto index = static_cast<size_t>(id.index().value_or(0));
    if (index >= packed.instances.size()) return {};
    for (const ltm::PackedMedium& medium : packed.instances[index].value.media)
      if (medium.path == path && !medium.group) bytes = medium.bytes.size();
    return {};
  });
  return status.ok() ? bytes : std::nullopt;
}

std::string decimal(double number) {
  return std::isfinite(number) ? fmt::format("{:.6g}", number) : "";
}

/// What the headers tell of an image, beside its bytes.
struct ImageNotes {
  ltm::Source source = ltm::Source::kRecorded;
  std::string model;
  std::string engine;
  double psnr_db = std::nan("");
  double expected_error = std::nan("");
  double bound = std::nan("");
  std::optional<uint64_t> bytes;
};

ImageNotes notes_of(const ltm::SnapshotResult& snapshot, const ltm::MemoryId& id) {
  ImageNotes notes{snapshot.source, snapshot.model, snapshot.predictor};
  const ltm::InstanceResult* instance = snapshot.find(id.index().value_or(0));
  if (instance == nullptr) return notes;
  // Beside an image only the errors of images count.
  const auto share_of = [](double mse) { return error_number({mse, std::nan("")}); };
  if (instance->error) {
    notes.psnr_db = training::psnr_db(instance->error->image_mse);
    notes.expected_error = share_of(instance->error->image_mse);
  }
  if (instance->bound) notes.bound = share_of(instance->bound->image_mse);
  return notes;
}

/// One image in the form that was asked for.
struct ImageOfForm {
  reports::ShownImage image;
  ImageNotes notes;
};

Result<ImageOfForm> image_of_form(ViewedMemory& viewed, const RequestTarget& target,
                                  const ltm::MemoryId& id, const std::string& path,
                                  const std::string& form) {
  if (form == "error") {
    ENGRAM_ASSIGN_OR_RETURN(const FoundImage recorded, recorded_image(viewed, id, path));
    ENGRAM_ASSIGN_OR_RETURN(const FoundImage latent, latent_image(viewed, id, path));
    ENGRAM_ASSIGN_OR_RETURN(reports::ShownImage map,
                            reports::error_map(recorded.image, latent.image));
    ImageNotes notes = notes_of(latent.snapshot, id);
    ENGRAM_ASSIGN_OR_RETURN(const double mse, training::image_mse(recorded.image, latent.image));
    notes.psnr_db = training::psnr_db(mse);
    return ImageOfForm{std::move(map), std::move(notes)};
  }
  auto found = form == "predicted"  ? predicted_image(viewed, target, id, path)
               : form == "latent"   ? latent_image(viewed, id, path)
               : form == "recorded" ? recorded_image(viewed, id, path)
                                    : recalled_image(viewed.memory(), id, path);
  ENGRAM_RETURN_IF_ERROR(found.status());
  ImageNotes notes = notes_of(found->snapshot, id);
  if (notes.source == ltm::Source::kRecorded) notes.bytes = stored_bytes_of(viewed, id, path);
  return ImageOfForm{reports::shown_image(found->image), std::move(notes)};
}

}  // namespace

ViewAnswer answer_image(ViewedMemory& viewed, const HttpRequest& request,
                        const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, target.moment("id"));
  const std::string path = target.find("path").value_or("");
  ENGRAM_ASSIGN_OR_RETURN(
      const std::string form,
      target.choice("form", {"any", "recorded", "latent", "predicted", "error"}, "any"));
  ENGRAM_ASSIGN_OR_RETURN(const std::string as, target.choice("as", {"jpeg", "png"}, "png"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t quality, target.integer("quality", 1, 100, 92));
  ENGRAM_ASSIGN_OR_RETURN(const ImageOfForm found, image_of_form(viewed, target, id, path, form));
  HttpResponse response{.type = "image/" + as};
  ENGRAM_ASSIGN_OR_RETURN(
      response.body, reports::encoded_image(found.image.pixels, as, static_cast<int>(quality)));
  const std::string etag = fmt::format("\"{:016x}\"", ltm::checksum(as_bytes(response.body)));
  // A snapshot may be forgotten, redacted or recorded again, so a browser asks each time.
  response.headers = {{"Cache-Control", "private, no-cache"},
                      {"ETag", etag},
                      {"X-Engram-Source", std::string(ltm::to_string(found.notes.source))},
                      {"X-Engram-Width", std::to_string(found.image.pixels.shape()[1])},
                      {"X-Engram-Height", std::to_string(found.image.pixels.shape()[0])}};
  const auto add = [&response](const char* name, const std::string& value) {
    if (!value.empty()) response.headers.emplace_back(name, header_text(value));
  };
  add("X-Engram-Model", found.notes.model);
  add("X-Engram-Engine", found.notes.engine);
  add("X-Engram-PSNR", decimal(found.notes.psnr_db));
  add("X-Engram-Expected-Error", decimal(found.notes.expected_error));
  add("X-Engram-Bound", decimal(found.notes.bound));
  if (found.notes.bytes) add("X-Engram-Bytes", std::to_string(*found.notes.bytes));
  if (form == "error") add("X-Engram-Gain", decimal(found.image.gain));
  if (found.image.range) {
    add("X-Engram-Min", decimal(found.image.range->first));
    add("X-Engram-Max", decimal(found.image.range->second));
  }
  if (request.if_none_match == etag) {
    response.status = 304;
    response.body.clear();
  }
  return response;
}

}  // namespace engram::viewer
