// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/channel.h"

#include <sys/socket.h>

#include <cstring>

namespace engram::server {

namespace {

/// Room for one descriptor. If a peer sends more, the kernel closes the rest and reports it.
union Control {
  cmsghdr header;
  char bytes[CMSG_SPACE(sizeof(int))];
};

Descriptor take_descriptor(msghdr& packet) {
  const cmsghdr* const header = CMSG_FIRSTHDR(&packet);
  if (header == nullptr || header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS ||
      header->cmsg_len != CMSG_LEN(sizeof(int)))
    return Descriptor();
  int fd = -1;
  std::memcpy(&fd, CMSG_DATA(header), sizeof(fd));
  return Descriptor(fd);
}

}  // namespace

Status send_message(int socket, const Message& message, int descriptor) {
  iovec content{const_cast<Message*>(&message), sizeof(message)};
  msghdr packet{};
  packet.msg_iov = &content;
  packet.msg_iovlen = 1;
  Control control{};
  if (descriptor >= 0) {
    packet.msg_control = &control;
    packet.msg_controllen = sizeof(control);
    cmsghdr* const header = CMSG_FIRSTHDR(&packet);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(header), &descriptor, sizeof(descriptor));
  }
  ssize_t sent = 0;
  do {
    sent = ::sendmsg(socket, &packet, MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent == static_cast<ssize_t>(sizeof(message))) return {};
  if (errno == EAGAIN || errno == EWOULDBLOCK)
    return resource_exhausted("sharing: the peer does not read what it is sent");
  return unavailable("sharing: cannot send: {}", std::generic_category().message(errno));
}

Result<std::optional<Arrived>> receive_message(int socket, Descriptors descriptors) {
  Arrived arrived;
  iovec content{&arrived.message, sizeof(arrived.message)};
  msghdr packet{};
  packet.msg_iov = &content;
  packet.msg_iovlen = 1;
  Control control{};
  // Without a buffer for them, the kernel closes descriptors that the peer sent.
  if (descriptors == Descriptors::kAccept) {
    packet.msg_control = &control;
    packet.msg_controllen = sizeof(control);
  }
  ssize_t count = 0;
  do {
    count = ::recvmsg(socket, &packet, MSG_CMSG_CLOEXEC);
  } while (count < 0 && errno == EINTR);
  if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return std::optional<Arrived>();
  if (count < 0)
    return unavailable("sharing: cannot receive: {}", std::generic_category().message(errno));
  if (count == 0) return unavailable("sharing: the peer is gone");
  arrived.descriptor = take_descriptor(packet);
  const bool is_whole = count == static_cast<ssize_t>(sizeof(Message)) &&
                        (packet.msg_flags & MSG_TRUNC) == 0 &&
                        arrived.message.magic == Message::kMagic;
  if (!is_whole)
    return data_loss("sharing: found a packet of {} bytes that is no message of {}", count,
                     sizeof(Message));
  return std::optional<Arrived>(std::move(arrived));
}

StatusCode status_code(const Message& message) {
  return message.status <= static_cast<uint32_t>(StatusCode::kCancelled)
             ? static_cast<StatusCode>(message.status)
             : StatusCode::kDataLoss;
}

}  // namespace engram::server
