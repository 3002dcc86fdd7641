// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <map>
#include <memory>

#include "datasets/mcap/channel_coder.h"
#include "datasets/mcap/ordered_messages.h"
#include "datasets/recordings/moment_order.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets::mcap {

/// Reads one MCAP file.
///
/// The time of a moment is the log time; `created` is the stamp of a message's header, else its
/// publish time. A file that has no summary, or ends early, is read as far as it goes.
/// Memory: that of OrderedMessages and one moment.
class McapReader final : public RecordingReader {
 public:
  static Result<std::unique_ptr<RecordingReader>> open(const std::filesystem::path& path,
                                                       const ReadingOptions& options);

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return total_; }
  Result<std::optional<Moment>> next() override;

 private:
  struct Channel {
    ltm::MemoryId entity;
    ChannelCoder coder;
    std::optional<uint64_t> last_log_time;
    std::optional<uint32_t> sequence;
  };

  McapReader(FileWindow file, const ReadingOptions& options)
      : file_(std::move(file)), options_(options), shift_(options.start) {}

  Status prepare();
  Status add_channels();
  void describe(const ChannelRecord& channel, const SchemaRecord* schema);
  Result<idf::Data> first_value(uint16_t id, const ChannelCoder& coder);
  Result<std::optional<ltm::EntityUpdate>> pull();
  Status describe_attachments();
  Result<std::optional<ltm::EntityUpdate>> next_attachment();
  std::optional<ltm::EntityUpdate> update_of(Channel& channel, const MessageRecord& message);
  void watch_sequence(Channel& channel, uint32_t sequence);
  void put_in_order(std::optional<uint64_t>& last_log_time, uint64_t log_time,
                    ltm::EntityUpdate& update);
  Time shifted(uint64_t ns);
  RecordingEpisode episode(Time start);

  FileWindow file_;
  ReadingOptions options_;
  FileMap map_;
  std::vector<RecordingStream> streams_;
  std::map<uint16_t, Channel> channels_;
  FreeEntities entities_;
  std::unique_ptr<OrderedMessages> messages_;
  std::optional<size_t> loaded_index_;  ///< The region that first_value read last.
  LoadedRegion loaded_;
  uint64_t total_ = 0;
  TimeShift shift_;
  std::optional<MessageRecord> message_;  ///< The message that was read and not taken yet.
  ltm::MemoryId attachments_;
  size_t next_attachment_ = 0;
  std::optional<uint64_t> last_attachment_time_;
  MomentOrder order_;
  MomentsOfValues moments_{[this] { return pull(); }};
  bool has_begun_ = false;
};

}  // namespace engram::datasets::mcap
