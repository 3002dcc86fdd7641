// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/forgetting/erasure.h"
#include "ltm/store/store_reader.h"
#include "training/fade/entity_coder.h"
#include "training/fade/fading_group.h"
#include "training/fade/learned_from.h"

// Private to this room: includes LibTorch.

namespace engram::training {

/// Takes what is erased out of what stays of one entity: its blocks of latents and its models.
///
/// Threading: one thread, which starts others for videos.
class EntityErasing {
 public:
  /// All arguments must outlive this object.
  EntityErasing(const std::filesystem::path& store, const ltm::MemoryId& entity,
                const ltm::ForgetSet& gone, const ProgressSink& progress,
                const std::stop_token& stop);

  /// Whether there may be something to do: the entity loses snapshots, or a model of it learned
  /// from others that go. With nothing to erase, what was cut before is looked for. Errors: those
  /// of reading models.
  Result<bool> open();

  /// Errors: kCancelled on a stop, before anything was published; those of the store and of coding.
  Status run();

  [[nodiscard]] ltm::EntityErasure& report() { return report_; }

 private:
  /// A model of the entity.
  struct Version {
    std::unique_ptr<EntityCoder> coder;
    Learned learned;
    /// The model without the pictures that go, for which its latents are copied; null if it stays.
    std::unique_ptr<EntityCoder> copy;

    /// What codes anew what stays.
    [[nodiscard]] EntityCoder& target() const { return copy ? *copy : *coder; }
  };
  /// Latents of one version in the order of time, and what they go to.
  using Made = std::vector<ltm::LatentSnapshot>;

  [[nodiscard]] bool goes(Time time) const;
  Status visit(const FadingGroup& group);
  /// Whether something of what is erased is in the bytes of a group.
  Result<bool> is_affected(const FadingGroup& group, const Version& version) const;
  /// Codes the latents of `part` anew, which are of `whole`.
  Result<FadingGroup> recode(const FadingGroup& whole, FadingGroup part, Version& from,
                             EntityCoder& with);
  Result<std::vector<idf::Data>> decoded(const FadingGroup& whole, const FadingGroup& part,
                                         Version& from) const;
  Result<std::shared_ptr<encoders::DeepModel>> fitted_to_tainted();
  /// Codes those anew whose model is tainted, with a model that is fitted to them.
  Status recode_tainted();
  Status publish_new(encoders::DeepModel& model, Made latents);
  Status publish();
  void tell() const;

  const std::filesystem::path& store_;
  const ltm::MemoryId& entity_;
  const ltm::ForgetSet& gone_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::unique_ptr<ltm::StoreReader> reader_;
  std::map<int, Version> versions_;
  std::map<int, Made> made_;  ///< By version, to be published.
  /// Groups of tainted models, whole, and what stays of them in latents alone.
  struct Tainted {
    FadingGroup whole, part;
  };
  std::vector<Tainted> tainted_;
  TimeSet unwanted_;  ///< Recorded snapshots whose latents go.
  uint64_t done_ = 0, all_ = 0;
  ltm::EntityErasure report_;
};

}  // namespace engram::training
