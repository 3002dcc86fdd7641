// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "ltm/recording/recording_config.h"
#include "store/image_reads.h"
#include "store/peer.h"

namespace engram::experiments {

namespace {

class EngramPeer final : public Peer {
 public:
  std::string name() const override { return "Engram, preset recorder"; }

  Status create(const std::filesystem::path& folder) override {
    ENGRAM_ASSIGN_OR_RETURN(const auto options,
                            ltm::parse_recording_config("preset: recorder\n", "recorder"));
    ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder, ltm::Recorder::open(folder / "store", options));
    recorder_.emplace(std::move(recorder));
    return {};
  }

  Status prepare(const Tick& tick) override {
    commit_ = commit_of(tick);
    return {};
  }

  Status append() override { return recorder_->commit(commit_); }

  Status close() override { return recorder_->close(); }

  Status open(const std::filesystem::path& folder) override {
    recorder_.reset();
    ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(folder / "store"));
    recall_.emplace(std::move(reader), ltm::ModelLoader());
    return {};
  }

  Result<Buffer> image(size_t camera, Time time) override {
    return read_image(*recall_, camera, time);
  }

 private:
  std::optional<ltm::Recorder> recorder_;
  ltm::Commit commit_;
  std::optional<ltm::Recall> recall_;
};

}  // namespace

std::unique_ptr<Peer> make_engram_peer() {
  return std::make_unique<EngramPeer>();
}

}  // namespace engram::experiments
