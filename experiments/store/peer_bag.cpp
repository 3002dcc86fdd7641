// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <span>

#include "store/bag_file.h"
#include "store/peer.h"

namespace engram::experiments {

namespace {

std::string camera_topic(size_t camera) {
  return fmt::format("/camera/{}/image", kCameras[camera]);
}

class BagPeer final : public Peer {
 public:
  explicit BagPeer(BagCompression compression) : compression_(compression) {}

  std::string name() const override {
    switch (compression_) {
      case BagCompression::kNone:
        return "ROS 1 bag";
      case BagCompression::kLz4:
        return "ROS 1 bag, LZ4";
      case BagCompression::kBz2:
        return "ROS 1 bag, BZ2";
    }
    return {};
  }

  Status create(const std::filesystem::path& folder) override {
    return bag_.create((folder / "stream.bag").string(), compression_);
  }

  Status prepare(const Tick& tick) override {
    bag_.begin(to_ns(tick.time));
    bag_.put_joints(tick.positions.data(), tick.velocities.data(), kJoints);
    for (size_t i = 0; i < tick.images.size(); ++i)
      bag_.put_image(camera_topic(i), tick.images[i].values<uint8_t>().data(), 640, 480);
    for (const Tick::Pose& pose : tick.poses) {
      const std::array<float, 16>& m = pose.matrix;
      bag_.put_pose("/pose/" + pose.name, static_cast<double>(m[3]), static_cast<double>(m[7]),
                    static_cast<double>(std::atan2(m[4], m[0])));
    }
    if (!tick.text.empty()) bag_.put_text(tick.text);
    return {};
  }

  Status append() override { return bag_.write(); }
  Status close() override { return bag_.close(); }

  Status open(const std::filesystem::path& folder) override {
    return bag_.open((folder / "stream.bag").string());
  }

  Result<Buffer> image(size_t camera, Time time) override {
    ENGRAM_ASSIGN_OR_RETURN(const auto pixels, bag_.image(camera_topic(camera), to_ns(time)));
    return Buffer(pixels, std::as_bytes(std::span(*pixels)));
  }

 private:
  BagCompression compression_;
  BagFile bag_;
};

}  // namespace

std::unique_ptr<Peer> make_bag_peer(BagCompression compression) {
  return std::make_unique<BagPeer>(compression);
}

}  // namespace engram::experiments
