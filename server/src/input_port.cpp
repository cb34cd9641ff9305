#include "input_port.h"

#include <algorithm>

namespace server {

InputPort::InputPort(int fd, std::uint64_t session, std::size_t capacity)
    : fd_(fd), session_(session) {
  players_.reserve(capacity);
  for (int i = 0; i < kBatch; ++i) {
    parts_[i] = {buffers_[i].data(), buffers_[i].size()};
    messages_[i].msg_hdr.msg_iov = &parts_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
  }
}

void InputPort::add(std::uint32_t client, std::uint64_t token, RemoteSource* source) {
  players_.push_back({client, token, source});
}

void InputPort::remove(std::uint32_t client) {
  std::erase_if(players_, [client](const Player& p) { return p.client == client; });
}

int InputPort::receive_batch() {
  return ::recvmmsg(fd_, messages_.data(), kBatch, MSG_DONTWAIT, nullptr);
}

void InputPort::receive(std::int64_t now_us) {
  for (int taken = 0; taken < kMaxPerTick; taken += kBatch) {
    const int count = receive_batch();
    for (int i = 0; i < count; ++i) take({buffers_[i].data(), messages_[i].msg_len}, now_us);
    if (count < kBatch) return;
  }
}

void InputPort::take(std::span<const std::byte> datagram, std::int64_t now_us) {
  wire::InputDatagram input;
  if (datagram.size() > wire::kMaxInputDatagram || !wire::decode_input(datagram, input)) {
    ++counters_.bad;
    return;
  }
  const auto player = std::find_if(players_.begin(), players_.end(),
                                   [&](const Player& p) { return p.token == input.token; });
  if (input.session != session_ || player == players_.end() || player->source == nullptr) {
    ++counters_.foreign;
  } else if (!player->source->accept(input, now_us)) {
    ++counters_.stale;
  } else {
    ++counters_.accepted;
  }
}

}  // namespace server
