// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/ticket_book.h"

#include <gtest/gtest.h>

namespace engram::server {
namespace {

constexpr Time kNow = Time(std::chrono::seconds(1000));
constexpr Duration kLifetime = std::chrono::seconds(30);

TEST(TicketBook, RedeemsATicketOnce) {
  TicketBook book(kLifetime, 10);
  const Ticket first = *book.issue({1, {7, 8}}, kNow);
  const Ticket second = *book.issue({2, {}}, kNow);
  EXPECT_NE(first, second);
  const auto holder = book.redeem(first, kNow);
  ASSERT_TRUE(holder.has_value());
  EXPECT_EQ(holder->client, 1u);
  EXPECT_EQ(holder->readable, (std::vector<GroupId>{7, 8}));
  EXPECT_FALSE(book.redeem(first, kNow).has_value());
  EXPECT_TRUE(book.redeem(second, kNow).has_value());
}

TEST(TicketBook, RefusesWhatWasNotIssued) {
  TicketBook book(kLifetime, 10);
  Ticket ticket{};
  EXPECT_FALSE(book.redeem(ticket, kNow).has_value());
  ticket = *book.issue({1, {}}, kNow);
  ticket.back() ^= std::byte{1};
  EXPECT_FALSE(book.redeem(ticket, kNow).has_value());
}

TEST(TicketBook, RefusesOldTickets) {
  TicketBook book(kLifetime, 10);
  const Ticket ticket = *book.issue({1, {}}, kNow);
  EXPECT_FALSE(book.redeem(ticket, kNow + kLifetime).has_value());
}

TEST(TicketBook, KeepsTheNewestTicketOfAClient) {
  TicketBook book(kLifetime, 10);
  const Ticket earlier = *book.issue({1, {}}, kNow);
  const Ticket later = *book.issue({1, {}}, kNow);
  EXPECT_FALSE(book.redeem(earlier, kNow).has_value());
  EXPECT_TRUE(book.redeem(later, kNow).has_value());
}

TEST(TicketBook, IsBounded) {
  TicketBook book(kLifetime, 2);
  ASSERT_TRUE(book.issue({1, {}}, kNow).ok());
  ASSERT_TRUE(book.issue({2, {}}, kNow).ok());
  EXPECT_EQ(book.issue({3, {}}, kNow).status().code(), StatusCode::kResourceExhausted);
  EXPECT_TRUE(book.issue({3, {}}, kNow + kLifetime).ok());
}

}  // namespace
}  // namespace engram::server
