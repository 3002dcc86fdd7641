// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/gateway.h"
#include "viewer/viewed_memory.h"
#include "viewer/visitor_gate.h"

namespace engram::viewer {

/// Shows memories in the browser of this machine: a page, and what it asks for. It changes nothing.
///
/// Threading: one thread.
/// Source: docs/viewer.md.
class Viewer {
 public:
  struct Options {
    /// At least one; the page shows one at a time, the first one first.
    std::vector<ViewedMemory::Options> memories;
    /// Where to listen: HOST:PORT of this machine alone, port 0: any.
    std::string listen = "127.0.0.1:0";
    /// The origin of a page that may show this one in a frame; empty: none may.
    std::string embedding_origin{};
  };

  /// Opens the memories and serves them until this object ends.
  /// Errors: kInvalidArgument naming the endpoint or the origin; kFailedPrecondition if others than
  /// this machine could reach it; those of ViewedMemory::open and Gateway::listen.
  static Result<std::unique_ptr<Viewer>> start(Options options);

  /// Calls off questions that take long, and ends after the other ones.
  ~Viewer();

  /// What a person opens. It has the token, so who sees it may look.
  [[nodiscard]] std::string url() const { return gate_->url(); }

  /// Answers one request: who may look, then the page and what it asks. Never throws.
  /// Threading: thread-safe.
  [[nodiscard]] HttpResponse respond(const HttpRequest& request) const;

 private:
  Viewer() = default;

  [[nodiscard]] std::optional<HttpResponse> stop_socket(const HttpRequest& request) const;
  [[nodiscard]] Result<HttpResponse> page_or_answer(const HttpRequest& request,
                                                    const RequestTarget& target) const;
  [[nodiscard]] HttpResponse names() const;
  void follow(size_t number);

  std::vector<std::unique_ptr<ViewedMemory>> memories_;
  std::unique_ptr<VisitorGate> gate_;
  std::unique_ptr<Gateway> gateway_;                          ///< Ends before what it calls.
  std::vector<std::unique_ptr<Subscription>> subscriptions_;  ///< End first: they call the gateway.
};

}  // namespace engram::viewer
