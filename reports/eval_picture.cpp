// SPDX-License-Identifier: Apache-2.0
#include "reports/eval_picture.h"

#include <algorithm>

#include "encoders/load_model.h"
#include "ltm/recall/recall.h"
#include "reports/contact_sheet.h"
#include "reports/plain/text.h"
#include "training/quality/quality_metrics.h"

namespace engram::reports {

namespace {

constexpr size_t kEvalColumns = 6;

/// Indices of snapshots that are both recorded and latent, with two recorded snapshots before them.
std::vector<size_t> candidates(const std::vector<ltm::SnapshotEntry>& entries) {
  std::vector<size_t> found;
  for (size_t i = 2; i < entries.size(); ++i)
    if (entries[i].recorded && entries[i].latent && entries[i - 1].recorded &&
        entries[i - 2].recorded)
      found.push_back(i);
  return found;
}

struct Sheet {
  PictureRow recorded{"recorded", {}};
  PictureRow reconstructed{"reconstructed", {}};
  PictureRow predicted{"predicted", {}};
  PictureRow error{fmt::format("error x {}", kDifferenceGain), {}};
  std::vector<std::string> labels;
};

Result<idf::Data> predicted_value(ltm::Predictor& predictor, ltm::StoreReader& reader,
                                  const ltm::MemoryId& entity,
                                  const std::vector<ltm::SnapshotEntry>& entries, size_t index) {
  std::vector<idf::Data> history;
  for (size_t past = index - 2; past < index; ++past) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot snapshot,
                            reader.read_recorded(entity, entries[past]));
    history.push_back(snapshot.instances.front().data);
  }
  ENGRAM_ASSIGN_OR_RETURN(auto values, predictor.predict(history, 1));
  return std::move(values.front().value);
}

/// Adds one moment as a column; does nothing if its values have no image.
Status add_column(Sheet& sheet, ltm::Recall& recall, ltm::Predictor& predictor,
                  const ltm::MemoryId& entity, const std::vector<ltm::SnapshotEntry>& entries,
                  size_t index) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot recorded,
                          recall.store().read_recorded(entity, entries[index]));
  const auto query = ltm::Query::of_entity(entity, ltm::select::At{entries[index].time});
  ENGRAM_ASSIGN_OR_RETURN(const auto answer,
                          recall.query(query, {.prefer = ltm::Recall::Prefer::kLatent}));
  const ltm::SnapshotResult& latent = answer.entities().front()->snapshots.front();
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data predicted,
                          predicted_value(predictor, recall.store(), entity, entries, index));
  const idf::NdArray* truth = first_image(recorded.instances.front().data);
  const idf::NdArray* decoded = first_image(latent.instances.front().data);
  const idf::NdArray* future = first_image(predicted);
  if (truth == nullptr || decoded == nullptr || future == nullptr) return {};
  sheet.recorded.images.push_back(*truth);
  sheet.reconstructed.images.push_back(*decoded);
  sheet.predicted.images.push_back(*future);
  sheet.error.images.push_back(difference(*truth, *decoded));
  sheet.labels.push_back("PSNR " +
                         db_text(training::psnr_db(latent.instances.front().error->image_mse)));
  return {};
}

}  // namespace

Status write_eval_picture(const std::filesystem::path& store,
                          const std::filesystem::path& picture) {
  ENGRAM_ASSIGN_OR_RETURN(auto opened, ltm::StoreReader::open(store));
  ltm::Recall recall(std::move(opened), encoders::load_model);
  for (const ltm::ModelInfo& model : recall.store().manifest().models) {
    ENGRAM_ASSIGN_OR_RETURN(const auto* entries, recall.store().index(model.entity));
    ENGRAM_ASSIGN_OR_RETURN(const auto loaded, encoders::load_model(store / model.file));
    const std::vector<size_t> moments = candidates(*entries);
    Sheet sheet;
    for (size_t column = 0; column < std::min(kEvalColumns, moments.size()); ++column)
      ENGRAM_RETURN_IF_ERROR(
          add_column(sheet, recall, *loaded.predictor, model.entity, *entries,
                     moments[(2 * column + 1) * moments.size() / (2 * kEvalColumns)]));
    if (sheet.labels.empty()) continue;
    return write_contact_sheet(
        picture, {sheet.recorded, sheet.reconstructed, sheet.predicted, sheet.error}, sheet.labels);
  }
  return not_found("store '{}': no entity has images that are recorded and reconstructed",
                   store.string());
}

}  // namespace engram::reports
