// SPDX-License-Identifier: Apache-2.0
// The only source with Boost: its headers take 20 s to compile.
#include "viewer/gateway.h"

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <optional>
#include <thread>

#include "ltm/core/log.h"

namespace engram::viewer {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;

std::string text_of(beast::string_view text) {
  return {text.data(), text.size()};
}

class LiveSocket;

/// What all connections of a gateway share. It outlives them.
struct Shared {
  Gateway::Options options;
  Gateway::Handle handle;
  Gateway::Admit admit;
  std::vector<std::weak_ptr<LiveSocket>> sockets;  ///< Of the thread that reads and writes.
  asio::thread_pool* workers = nullptr;
  std::atomic<size_t> connections{0};
  std::atomic<size_t> waiting{0};

  explicit Shared(const Gateway::Options& given) : options(given) {}
};

struct Frame {
  std::shared_ptr<const std::string> text;
  uint64_t snapshots = 0;  ///< That it tells of.
};

/// A WebSocket that is told what is committed. What comes from it is read and ignored, because only
/// reading notices that it ends.
class LiveSocket : public std::enable_shared_from_this<LiveSocket> {
 public:
  LiveSocket(tcp::socket socket, Shared& shared) : stream_(std::move(socket)), shared_(shared) {
    ++shared_.connections;
  }
  LiveSocket(const LiveSocket&) = delete;
  LiveSocket& operator=(const LiveSocket&) = delete;
  ~LiveSocket() { --shared_.connections; }

  void start(http::request<http::empty_body> request) {
    request_ = std::move(request);
    // Who answers no ping for some minutes is gone.
    stream_.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
    constexpr size_t kMaxMessage = 4096;
    stream_.read_message_max(kMaxMessage);
    stream_.async_accept(request_, [self = shared_from_this()](beast::error_code failed) {
      if (failed) return;
      self->is_open_ = true;
      self->read();
      self->write();
    });
  }

  void tell(const Frame& frame) {
    waiting_.push_back(frame);
    // The one in front may be on its way.
    while (waiting_.size() > shared_.options.max_socket_frames) {
      const auto oldest = waiting_.begin() + (is_writing_ ? 1 : 0);
      dropped_ += oldest->snapshots;
      waiting_.erase(oldest);
    }
    write();
  }

 private:
  void read() {
    stream_.async_read(received_, [self = shared_from_this()](beast::error_code failed, size_t) {
      if (failed) {
        self->is_open_ = false;
        return;
      }
      self->received_.clear();
      self->read();
    });
  }

  void write() {
    if (!is_open_ || is_writing_) return;
    if (dropped_ > 0) {
      const auto text = fmt::format(R"({{"kind":"dropped","count":{}}})", dropped_);
      waiting_.push_front({std::make_shared<const std::string>(text), 0});
      dropped_ = 0;
    }
    if (waiting_.empty()) return;
    is_writing_ = true;
    stream_.text(true);
    stream_.async_write(asio::buffer(*waiting_.front().text),
                        [self = shared_from_this()](beast::error_code failed, size_t) {
                          self->is_writing_ = false;
                          self->waiting_.pop_front();
                          if (failed) self->is_open_ = false;
                          self->write();
                        });
  }

  beast::websocket::stream<beast::tcp_stream> stream_;
  Shared& shared_;
  http::request<http::empty_body> request_;
  beast::flat_buffer received_;
  std::deque<Frame> waiting_;
  uint64_t dropped_ = 0;
  bool is_open_ = false;
  bool is_writing_ = false;
};

/// One connection: a request is read, answered and then the next one is read. It lives as long as
/// something waits for it. All but `handle` runs in the thread that reads and writes.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Shared& shared)
      : stream_(std::move(socket)), shared_(shared), buffer_(shared.options.max_header_bytes) {
    ++shared_.connections;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { --shared_.connections; }

  void start() { read(shared_.options.first_request); }

 private:
  using Parser = http::request_parser<http::empty_body>;

  void read(Duration limit) {
    // Bodies are refused: nothing is ever sent here. The first one tells no limit to itself.
    parser_.emplace();
    parser_->header_limit(static_cast<uint32_t>(shared_.options.max_header_bytes));
    parser_->body_limit(0);
    stream_.expires_after(limit);
    http::async_read(
        stream_, buffer_, *parser_,
        [self = shared_from_this()](beast::error_code failed, size_t) { self->on_read(failed); });
  }

  void on_read(beast::error_code failed) {
    if (!failed) return dispatch();
    if (failed == http::error::header_limit || failed == http::error::buffer_overflow)
      return refuse(431, "the request is too long");
    if (failed == http::error::body_limit || failed == http::error::unexpected_body)
      return refuse(413, "the request has a body, needs none");
    // A connection that ends, or was too slow, is told nothing.
    if (failed.category() == http::make_error_code(http::error::bad_method).category() &&
        failed != http::error::end_of_stream && failed != http::error::partial_message)
      return refuse(400, "the request is no HTTP/1.1");
    close();
  }

  void refuse(int status, const char* reason) {
    is_kept_ = false;
    write(error_response(status, invalid_argument("{}", reason)), false);
  }

  void dispatch() {
    const auto& message = parser_->get();
    is_kept_ = message.keep_alive();
    if (message.count(http::field::host) != 1)
      return refuse(400, "the request needs one header 'Host'");
    const auto header = [&message](auto field) { return text_of(message[field]); };
    HttpRequest request{.method = text_of(message.method_string()),
                        .target = text_of(message.target()),
                        .host = header(http::field::host),
                        .origin = header(http::field::origin),
                        .cookie = header(http::field::cookie),
                        .accept_encoding = header(http::field::accept_encoding),
                        .if_none_match = header(http::field::if_none_match),
                        .fetch_site = header("Sec-Fetch-Site")};
    if (beast::websocket::is_upgrade(message)) return upgrade(request);
    if (shared_.waiting >= shared_.options.max_waiting)
      return write(error_response(unavailable("too many requests wait: ask again")), false);
    ++shared_.waiting;
    stream_.expires_never();
    asio::post(*shared_.workers, [self = shared_from_this(), asked = std::move(request)] {
      HttpResponse response = self->shared_.handle(asked);
      --self->shared_.waiting;
      const bool is_head = asked.method == "HEAD";
      asio::post(self->stream_.get_executor(),
                 [self, is_head, made = std::move(response)]() mutable {
                   self->write(std::move(made), is_head);
                 });
    });
  }

  void upgrade(const HttpRequest& request) {
    is_kept_ = false;
    if (auto refused = shared_.admit(request)) return write(*std::move(refused), false);
    auto& sockets = shared_.sockets;
    std::erase_if(sockets, [](const auto& socket) { return socket.expired(); });
    if (sockets.size() >= shared_.options.max_sockets)
      return write(error_response(unavailable("too many pages are open: close one")), false);
    stream_.expires_never();
    const auto socket = std::make_shared<LiveSocket>(stream_.release_socket(), shared_);
    sockets.push_back(socket);
    socket->start(parser_->get());
  }

  void write(HttpResponse response, bool is_head) {
    response_.emplace();
    response_->result(static_cast<unsigned>(response.status));
    response_->version(11);
    for (const auto& [name, value] : response.headers) response_->insert(name, value);
    response_->set(http::field::content_type, response.type);
    response_->keep_alive(is_kept_);
    const size_t bytes = response.body.size();
    if (!is_head) response_->body() = std::move(response.body);
    // What has no body by its status has no length either.
    if (response.status != 304) response_->content_length(bytes);
    stream_.expires_after(shared_.options.write);
    serializer_.emplace(*response_);
    const auto done = [self = shared_from_this()](beast::error_code failed, size_t) {
      if (failed || !self->is_kept_) return self->close();
      self->read(self->shared_.options.next_request);
    };
    if (is_head || response.status == 304)
      http::async_write_header(stream_, *serializer_, done);
    else
      http::async_write(stream_, *serializer_, done);
  }

  void close() {
    beast::error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_both, ignored);
    stream_.close();
  }

  beast::tcp_stream stream_;
  Shared& shared_;
  beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  std::optional<http::response<http::string_body>> response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  bool is_kept_ = true;
};

}  // namespace

struct Gateway::State {
  // In this order: what waits for a worker holds connections, these belong to the context, and use
  // what is shared until they end.
  Shared shared;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer pause{context};
  asio::thread_pool workers;
  std::thread thread;

  explicit State(const Options& options) : shared(options), workers(options.workers) {
    shared.workers = &workers;
  }

  void accept() {
    acceptor.async_accept([this](beast::error_code failed, tcp::socket socket) {
      if (failed == asio::error::operation_aborted) return;
      if (failed) return accept_later(failed);
      // A socket that goes out of scope is closed.
      if (shared.connections < shared.options.max_connections)
        std::make_shared<Connection>(std::move(socket), shared)->start();
      accept();
    });
  }

  /// The process may have no file descriptors left, which others give back.
  void accept_later(beast::error_code failed) {
    log::warning("viewer: a connection was not accepted: {}", failed.message());
    pause.expires_after(std::chrono::milliseconds(100));
    pause.async_wait([this](beast::error_code aborted) {
      if (!aborted) accept();
    });
  }

  void run() {
    while (!context.stopped()) {
      try {
        context.run();
      } catch (const std::exception& error) {
        log::warning("viewer: a connection failed: {}", error.what());
      }
    }
  }
};

Gateway::Gateway(std::unique_ptr<State> state) : state_(std::move(state)) {}

Gateway::~Gateway() {
  state_->context.stop();
  if (state_->thread.joinable()) state_->thread.join();
  state_->workers.stop();
  state_->workers.join();
}

Result<std::unique_ptr<Gateway>> Gateway::listen(const Options& options) {
  beast::error_code failed;
  const auto address = asio::ip::make_address(options.address, failed);
  if (failed)
    return invalid_argument("'{}': is no address, needs one such as 127.0.0.1", options.address);
  auto state = std::make_unique<State>(options);
  const tcp::endpoint endpoint(address, options.port);
  tcp::acceptor& acceptor = state->acceptor;
  acceptor.open(endpoint.protocol(), failed);
  if (!failed) acceptor.set_option(asio::socket_base::reuse_address(true), failed);
  if (!failed) acceptor.bind(endpoint, failed);
  if (!failed) acceptor.listen(asio::socket_base::max_listen_connections, failed);
  if (failed)
    return unavailable("'{}' port {}: {}", options.address, options.port, failed.message());
  return std::unique_ptr<Gateway>(new Gateway(std::move(state)));
}

uint16_t Gateway::port() const {
  return state_->acceptor.local_endpoint().port();
}

void Gateway::serve(Handle handle, Admit admit) {
  state_->shared.handle = std::move(handle);
  state_->shared.admit = std::move(admit);
  state_->accept();
  state_->thread = std::thread([this] { state_->run(); });
}

void Gateway::publish(std::string text, uint64_t snapshots) {
  asio::post(
      state_->context,
      [this, frame = Frame{std::make_shared<const std::string>(std::move(text)), snapshots}] {
        for (const auto& socket : state_->shared.sockets)
          if (const auto open = socket.lock()) open->tell(frame);
      });
}

}  // namespace engram::viewer
