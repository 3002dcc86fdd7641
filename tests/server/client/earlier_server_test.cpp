// SPDX-License-Identifier: Apache-2.0
// What a program says of a server of an earlier version, which answers queries alone.
#include <engram/v1/memory.grpc.pb.h>
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include "memory/memory.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::server {
namespace {

using ::testing::HasSubstr;

/// Answers every query with the ID of one snapshot, as a server does that does not know
/// QueryRequest.prediction.
class EarlierServer final : public v1::MemoryServer::Service {
 public:
  grpc::Status Query(grpc::ServerContext* /*call*/,
                     grpc::ServerReaderWriter<v1::QueryReply, v1::QueryRequest>* stream) override {
    v1::QueryRequest request;
    while (stream->Read(&request)) {
      queries.push_back(request.query());
      v1::QueryReply reply;
      reply.set_number(request.number());
      reply.set_is_last(true);
      v1::EntityAnswer& entity = *reply.add_entities();
      entity.set_entity("Objects/Things/kitchen/cup");
      v1::Snapshot& snapshot = *entity.add_snapshots();
      snapshot.set_time_ns(1000);
      snapshot.add_instances()->set_index(0);
      stream->Write(reply);
    }
    return grpc::Status::OK;
  }

  /// Does not know EnginesRequest.at_ns.
  grpc::Status Engines(grpc::ServerContext* /*call*/, const v1::EnginesRequest* request,
                       v1::EnginesReply* reply) override {
    v1::EnginesReply::Record& record = *reply->add_records();
    record.set_engine("copy-last");
    record.set_horizon_ns(request->horizons_ns(0));
    return grpc::Status::OK;
  }

  std::vector<std::string> queries;
};

TEST(EarlierServer, IsNotTakenForOneThatPredictsFromAMoment) {
  const ScratchDirectory scratch;
  const std::string endpoint = "unix:" + (scratch.path() / "s").string();
  EarlierServer service;
  grpc::ServerBuilder builder;
  builder.AddListeningPort(endpoint, grpc::InsecureServerCredentials());
  builder.RegisterService(&service);
  const auto server = builder.BuildAndStart();
  ASSERT_NE(server, nullptr);
  {
    const auto memory = Memory::connect(endpoint);
    ASSERT_OK(memory);
    const auto cup = *ltm::MemoryId::parse("Objects/Things/kitchen/cup");
    const std::vector<Duration> ahead{std::chrono::milliseconds(200)};
    const auto from = (*memory)->predict(cup, ahead, {.at = time_from_ns(0)});
    EXPECT_FAILS(from, StatusCode::kFailedPrecondition, "from 1970-01-01 00:00:00");
    EXPECT_THAT(from.status().message(), HasSubstr("earlier version"));
    const auto planned = (*memory)->predict(cup, ahead, {.plan = cup});
    EXPECT_FAILS(planned, StatusCode::kFailedPrecondition, "with the plan '" + cup.to_string());
    EXPECT_FAILS((*memory)->engines(cup, ahead[0], time_from_ns(0)),
                 StatusCode::kFailedPrecondition, "earlier version");
    EXPECT_OK((*memory)->engines(cup, ahead[0]));
    EXPECT_FAILS((*memory)->similar({.entity = cup, .moment = time_from_ns(0)}),
                 StatusCode::kFailedPrecondition, "does not know this");
  }
  server->Shutdown();
  // Nothing is decoded for an answer that nobody wants.
  EXPECT_THAT(service.queries, ::testing::Each(HasSubstr("?ids Objects/Things/kitchen/cup")));
}

}  // namespace
}  // namespace engram::server
