// SPDX-License-Identifier: Apache-2.0
#include "server/access/endpoint.h"

#include <arpa/inet.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

namespace engram::server {

namespace {

constexpr std::string_view kUnixStart = "unix:";
/// One less than the field, because the path ends in a zero byte.
constexpr size_t kMaxPathBytes = sizeof(sockaddr_un::sun_path) - 1;
constexpr size_t kMaxHostBytes = 253;
constexpr size_t kMaxLabelBytes = 63;
/// The max length of a text that an error message quotes.
constexpr size_t kMaxQuoted = 80;

using AddressV4 = std::array<unsigned char, 4>;
using AddressV6 = std::array<unsigned char, 16>;

template <typename Address>
std::optional<Address> read_address(const std::string& host) {
  Address address{};
  const int family = std::is_same_v<Address, AddressV4> ? AF_INET : AF_INET6;
  if (host.find('\0') != std::string::npos) return std::nullopt;
  if (inet_pton(family, host.c_str(), address.data()) != 1) return std::nullopt;
  return address;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_label(std::string_view label) {
  const auto is_allowed = [](char c) {
    return is_digit(c) || is_letter(c) || c == '-' || c == '_';
  };
  return !label.empty() && label.size() <= kMaxLabelBytes && label.front() != '-' &&
         label.back() != '-' && std::ranges::all_of(label, is_allowed);
}

/// A name whose last label is a number is refused: it is an address in a notation that we do not
/// read.
bool is_host_name(std::string_view host) {
  if (host.size() > kMaxHostBytes) return false;
  while (true) {
    const size_t dot = host.find('.');
    const std::string_view label = host.substr(0, dot);
    if (!is_label(label)) return false;
    if (dot == std::string_view::npos) return !is_digit(label.front());
    host.remove_prefix(dot + 1);
  }
}

Status check_path(std::string_view path) {
  if (!path.starts_with('/')) return invalid_argument("needs an absolute path behind 'unix:'");
  if (path.size() > kMaxPathBytes)
    return invalid_argument("its path has {} bytes, at most {} are possible", path.size(),
                            kMaxPathBytes);
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(path, is_control)) return invalid_argument("has control characters");
  if (path.ends_with('/') || path.find("//") != std::string_view::npos)
    return invalid_argument("needs a path without empty names");
  return {};
}

Result<uint16_t> read_port(std::string_view text) {
  uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  const bool has_zeros = text.size() > 1 && text.front() == '0';
  if (error != std::errc() || end != text.data() + text.size() || has_zeros)
    return invalid_argument("needs a port from 0 to 65535 behind the last ':'");
  return port;
}

}  // namespace

Result<Endpoint> Endpoint::parse(std::string_view text) {
  const auto refuse = [text](const Status& why) {
    return why.with_context(fmt::format("endpoint '{}'", text.substr(0, kMaxQuoted)));
  };
  if (text.starts_with(kUnixStart)) {
    const std::string_view path = text.substr(kUnixStart.size());
    if (Status status = check_path(path); !status.ok()) return refuse(status);
    return Endpoint(Kind::kUnix, std::string(path), 0);
  }
  const size_t colon = text.rfind(':');
  if (colon == std::string_view::npos)
    return refuse(invalid_argument("needs unix:/PATH, HOST:PORT or [ADDRESS]:PORT"));
  const auto port = read_port(text.substr(colon + 1));
  if (!port.ok()) return refuse(port.status());
  std::string host(text.substr(0, colon));
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
    if (!read_address<AddressV6>(host))
      return refuse(invalid_argument("needs an IPv6 address inside of the brackets"));
    return Endpoint(Kind::kTcp, std::move(host), *port);
  }
  if (host.find(':') != std::string::npos)
    return refuse(invalid_argument("needs an IPv6 address in brackets, as in [::1]:50051"));
  if (!read_address<AddressV4>(host) && !is_host_name(host))
    return refuse(invalid_argument("needs the name or the address of a host before the port"));
  return Endpoint(Kind::kTcp, std::move(host), *port);
}

bool Endpoint::is_local() const {
  if (kind_ == Kind::kUnix) return true;
  if (const auto address = read_address<AddressV4>(place_)) return (*address)[0] == 127;
  if (const auto address = read_address<AddressV6>(place_)) {
    AddressV6 loopback{};
    loopback.back() = 1;
    return *address == loopback;
  }
  constexpr std::string_view kLocalHost = "localhost";
  return std::ranges::equal(place_, kLocalHost, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b;
  });
}

std::string Endpoint::to_string() const {
  if (kind_ == Kind::kUnix) return fmt::format("{}{}", kUnixStart, place_);
  if (place_.find(':') != std::string::npos) return fmt::format("[{}]:{}", place_, port_);
  return fmt::format("{}:{}", place_, port_);
}

}  // namespace engram::server
