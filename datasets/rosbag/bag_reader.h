// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <map>
#include <memory>
#include <set>

#include "datasets/recordings/moment_order.h"
#include "datasets/recordings/recording_format.h"
#include "datasets/rosbag/bag_map.h"
#include "datasets/rosbag/connection_coder.h"

namespace engram::datasets::rosbag {

/// Reads one bag.
///
/// The time of a moment is the time at which messages were recorded; `created` is the stamp of a
/// message's header, if it has one. A bag that has no index, or ends early, is read as far as it
/// goes.
/// Memory: that of OrderedRegions and one moment.
class BagReader final : public RecordingReader {
 public:
  static Result<std::unique_ptr<RecordingReader>> open(const std::filesystem::path& path,
                                                       const ReadingOptions& options);

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return total_; }
  Result<std::optional<Moment>> next() override;

 private:
  struct Topic {
    ltm::MemoryId entity;
    ConnectionCoder coder;
    std::optional<uint64_t> last_time;
  };

  BagReader(FileWindow file, const ReadingOptions& options)
      : file_(std::move(file)), options_(options), shift_(options.start) {}

  Status prepare();
  Status add_topic(const Connection& connection);
  void describe(const Connection& connection, const Topic& topic);
  Result<RegionMessages> load(const Region& region);
  Result<idf::Data> first_value(uint32_t connection, const ConnectionCoder& coder);
  Result<std::optional<ltm::EntityUpdate>> pull();
  std::optional<ltm::EntityUpdate> update_of(Topic& topic, const Message& message);
  void note(const std::string& what);

  FileWindow file_;
  ReadingOptions options_;
  TimeShift shift_;
  BagMap map_;
  std::vector<RecordingStream> streams_;
  std::map<uint32_t, Topic> topics_;
  FreeEntities entities_;
  std::unique_ptr<OrderedRegions> messages_;
  std::optional<size_t> loaded_index_;  ///< The region that first_value read last.
  RegionMessages loaded_;
  std::set<uint64_t> told_;  ///< Offsets of damaged regions that were reported.
  uint64_t total_ = 0;
  MomentOrder order_;
  MomentsOfValues moments_{[this] { return pull(); }};
  bool has_begun_ = false;
};

}  // namespace engram::datasets::rosbag
