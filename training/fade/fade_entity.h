// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/forgetting/fade_report.h"
#include "ltm/recall/model.h"
#include "training/fade/entity_coder.h"
#include "training/fade/fading_group.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Lets snapshots of one entity fade.
///
/// Threading: one thread, which starts others for videos.
class EntityFading {
 public:
  /// All arguments must outlive this object.
  EntityFading(const std::filesystem::path& store, const ltm::MemoryId& entity,
               const ProgressSink& progress, const std::stop_token& stop);
  ~EntityFading();
  EntityFading(const EntityFading&) = delete;
  EntityFading& operator=(const EntityFading&) = delete;

  /// Lets snapshots fade to a min PSNR in dB, or to a gist without one.
  /// Errors: kCancelled on a stop, after what was done by then was published; those of fade().
  Status run(const ltm::FadingSnapshots& what);

  [[nodiscard]] const ltm::EntityFadeReport& report() const { return report_; }

 private:
  /// Per instance of a group: how good its value is; nothing where it was recorded.
  using Qualities = std::vector<std::optional<ltm::LatentQuality>>;

  Result<EntityCoder*> coder_of(int version);
  Status visit(FadingGroup group, std::optional<double> psnr_db);
  Status fade(const FadingGroup& group, std::optional<double> psnr_db);
  /// Lets the groups that wait for more of them fade to one gist.
  Status fade_waiting();
  /// The best values that are there, of all instances, and how good they are.
  Result<std::vector<idf::Data>> best_values(const FadingGroup& group, EntityCoder& coder,
                                             Qualities& qualities);
  /// Codes values anew. The result is empty if no lower quality is allowed.
  Result<std::vector<ltm::Latent>> encode(EntityCoder& coder, const std::vector<idf::Data>& values,
                                          const Qualities& qualities, double psnr_db);
  Result<std::vector<ltm::Latent>> encode_as_gist(EntityCoder& coder,
                                                  const std::vector<idf::Data>& values);
  /// Whether the latents of a group may stay as they are although what is recorded of it goes.
  bool may_stay(const FadingGroup& group, EntityCoder& coder, const std::vector<idf::Data>& values,
                const Qualities& before, std::optional<double> psnr_db);
  void tell(const std::string& detail = {}) const;
  /// Keeps the group as `made`, with other latents or its own, and marks it as faded.
  void keep(const FadingGroup& group, FadingGroup made, std::optional<double> psnr_db);
  void count(const FadingGroup& before, const FadingGroup& after);
  /// Publishes what was coded.
  Status publish();
  /// Removes the other forms of what faded.
  Status remove_others();

  const std::filesystem::path& store_;
  const ltm::MemoryId& entity_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::unique_ptr<ltm::StoreReader> reader_;
  std::map<int, std::unique_ptr<EntityCoder>> coders_;    ///< By version of the model.
  std::map<int, std::vector<ltm::LatentSnapshot>> made_;  ///< Not published yet, by version.
  /// Groups that become one gist: the longer it is, the fewer bytes an image takes.
  FadingGroup gist_;
  uint64_t done_ = 0;    ///< Snapshots of this run.
  uint64_t wanted_ = 0;  ///< The same, of all.
  TimeSet faded_;        ///< Published or to be published; their other forms go.
  Time published_{};
  ltm::EntityFadeReport report_;
};

}  // namespace engram::training
