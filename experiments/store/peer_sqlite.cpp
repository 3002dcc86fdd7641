// SPDX-License-Identifier: Apache-2.0
#include <sqlite3.h>
#include <zstd.h>

#include <vector>

#include "store/peer.h"

namespace engram::experiments {

namespace {

constexpr const char* kSchema = R"(
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
CREATE TABLE message(topic TEXT NOT NULL, time INTEGER NOT NULL, data BLOB NOT NULL);
CREATE UNIQUE INDEX message_at ON message(topic, time);
)";
constexpr const char* kInsert = "INSERT INTO message VALUES (?, ?, ?)";
constexpr const char* kSelect = "SELECT data FROM message WHERE topic = ? AND time = ?";
constexpr int kTicksPerTransaction = 10;  // 100 ms

struct Message {
  std::string topic;
  Time time{};
  Buffer data;
};

template <typename T>
Buffer copy_of(const T& values) {
  return Buffer::copy(std::as_bytes(std::span(values)));
}

std::vector<Message> messages_of(const Tick& tick) {
  std::vector<Message> made{{"positions", tick.time, copy_of(tick.positions)},
                            {"velocities", tick.time, copy_of(tick.velocities)}};
  for (size_t i = 0; i < tick.images.size(); ++i)
    made.push_back({kCameras[i], tick.time, tick.images[i].buffer()});
  for (const Tick::Pose& pose : tick.poses)
    made.push_back({"pose/" + pose.name, tick.time, copy_of(pose.matrix)});
  if (!tick.text.empty()) made.push_back({"text", tick.time, copy_of(tick.text)});
  return made;
}

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

class SqlitePeer final : public Peer {
 public:
  explicit SqlitePeer(bool is_compressed) : is_compressed_(is_compressed) {}

  std::string name() const override {
    return is_compressed_ ? "SQLite, zstd blobs" : "SQLite, raw blobs";
  }

  Status create(const std::filesystem::path& folder) override {
    ENGRAM_RETURN_IF_ERROR(open_database(folder, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE));
    ENGRAM_RETURN_IF_ERROR(execute(kSchema));
    return compile(kInsert);
  }

  Status prepare(const Tick& tick) override {
    messages_ = messages_of(tick);
    return {};
  }

  Status append() override {
    if (ticks_ == 0) ENGRAM_RETURN_IF_ERROR(execute("BEGIN"));
    for (const Message& message : messages_) ENGRAM_RETURN_IF_ERROR(insert(message));
    ticks_ += 1;
    return ticks_ < kTicksPerTransaction ? Status() : commit();
  }

  Status close() override {
    if (ticks_ > 0) ENGRAM_RETURN_IF_ERROR(commit());
    statement_.reset();
    database_.reset();
    return {};
  }

  Status open(const std::filesystem::path& folder) override {
    ENGRAM_RETURN_IF_ERROR(open_database(folder, SQLITE_OPEN_READONLY));
    return compile(kSelect);
  }

  Result<Buffer> image(size_t camera, Time time) override {
    sqlite3_reset(statement_.get());
    ENGRAM_RETURN_IF_ERROR(bind_key(kCameras[camera], time));
    if (sqlite3_step(statement_.get()) != SQLITE_ROW)
      return not_found("database: no image of camera {} at {}", camera, to_string(time));
    const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), 0));
    const std::span bytes(data, static_cast<size_t>(sqlite3_column_bytes(statement_.get(), 0)));
    return is_compressed_ ? decompress(bytes) : Result<Buffer>(Buffer::copy(bytes));
  }

 private:
  Status failed(const char* what) const {
    return unavailable("sqlite: {}: {}", what, sqlite3_errmsg(database_.get()));
  }

  Status open_database(const std::filesystem::path& folder, int flags) {
    sqlite3* made = nullptr;
    const int code = sqlite3_open_v2((folder / "stream.db").c_str(), &made, flags, nullptr);
    database_.reset(made);
    return code == SQLITE_OK ? Status() : failed("open");
  }

  Status execute(const char* sql) {
    const int code = sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr);
    return code == SQLITE_OK ? Status() : failed(sql);
  }

  Status compile(const char* sql) {
    sqlite3_stmt* made = nullptr;
    const int code = sqlite3_prepare_v2(database_.get(), sql, -1, &made, nullptr);
    statement_.reset(made);
    return code == SQLITE_OK ? Status() : failed(sql);
  }

  Status commit() {
    ticks_ = 0;
    return execute("COMMIT");
  }

  Status bind_key(const std::string& topic, Time time) {
    const bool is_bound =
        sqlite3_bind_text(statement_.get(), 1, topic.data(), static_cast<int>(topic.size()),
                          SQLITE_TRANSIENT) == SQLITE_OK &&
        sqlite3_bind_int64(statement_.get(), 2, to_ns(time)) == SQLITE_OK;
    return is_bound ? Status() : failed("bind");
  }

  Status insert(const Message& message) {
    std::span<const std::byte> bytes = message.data.bytes();
    if (is_compressed_) {
      ENGRAM_ASSIGN_OR_RETURN(bytes, compress(bytes));
    }
    sqlite3_reset(statement_.get());
    ENGRAM_RETURN_IF_ERROR(bind_key(message.topic, message.time));
    // The bytes outlive the step below, so SQLite need not copy them.
    const int bound =
        sqlite3_bind_blob64(statement_.get(), 3, bytes.data(), bytes.size(), SQLITE_STATIC);
    if (bound != SQLITE_OK || sqlite3_step(statement_.get()) != SQLITE_DONE)
      return failed("insert");
    return {};
  }

  Result<std::span<const std::byte>> compress(std::span<const std::byte> plain) {
    room_.resize(ZSTD_compressBound(plain.size()));
    const size_t size = ZSTD_compressCCtx(compressor_.get(), room_.data(), room_.size(),
                                          plain.data(), plain.size(), ZSTD_CLEVEL_DEFAULT);
    if (ZSTD_isError(size) != 0) return unavailable("zstd: {}", ZSTD_getErrorName(size));
    return std::span<const std::byte>(room_).first(size);
  }

  Result<Buffer> decompress(std::span<const std::byte> bytes) {
    std::vector<std::byte> plain(size_t{640} * 480 * 3);
    const size_t size = ZSTD_decompressDCtx(decompressor_.get(), plain.data(), plain.size(),
                                            bytes.data(), bytes.size());
    if (ZSTD_isError(size) != 0) return data_loss("zstd: {}", ZSTD_getErrorName(size));
    return Buffer::take(std::move(plain));
  }

  struct FreeContext {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };

  bool is_compressed_;
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  Statement statement_;  ///< After the database, so that it is destroyed first.
  std::unique_ptr<ZSTD_CCtx, FreeContext> compressor_{ZSTD_createCCtx()};
  std::unique_ptr<ZSTD_DCtx, FreeContext> decompressor_{ZSTD_createDCtx()};
  std::vector<std::byte> room_;
  std::vector<Message> messages_;
  int ticks_ = 0;  ///< Ticks in the open transaction.
};

}  // namespace

std::unique_ptr<Peer> make_sqlite_peer(bool is_compressed) {
  return std::make_unique<SqlitePeer>(is_compressed);
}

}  // namespace engram::experiments
