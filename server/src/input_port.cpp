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

void InputPort::add(const Key& key, os::FileDescriptor socket, RemoteSource& source) {
  remove(key.client);
  players_.push_back({key, std::move(socket), &source, {key.seal, key.client}});
}

bool InputPort::redirect(std::uint32_t client, RemoteSource* source) {
  const auto player =
      std::ranges::find_if(players_, [client](const Player& p) { return p.key.client == client; });
  if (player == players_.end()) return false;
  player->source = source;
  return true;
}

void InputPort::remove(std::uint32_t client) {
  std::erase_if(players_, [client](const Player& p) { return p.key.client == client; });
}

int InputPort::receive_batch(int fd) {
  return ::recvmmsg(fd, messages_.data(), kBatch, MSG_DONTWAIT, nullptr);
}

void InputPort::receive(std::int64_t now_us) {
  for (Player& player : players_) receive_of(player, now_us);
  static_assert(kMaxStrayPerTick <= kBatch);
  const int strays = receive_batch(fd_);
  for (int i = 0; i < strays; ++i) {
    ++(messages_[i].msg_len < wire::kSealBytes || messages_[i].msg_len > kMaxSealed
           ? counters_.bad
           : counters_.foreign);
  }
}

void InputPort::receive_of(Player& player, std::int64_t now_us) {
  for (int taken = 0; taken < kMaxPerTick; taken += kBatch) {
    const int count = receive_batch(player.socket.get());
    for (int i = 0; i < count; ++i) take(player, datagram(i), now_us);
    if (count < kBatch) return;
  }
}

void InputPort::take(Player& player, std::span<const std::byte> sealed, std::int64_t now_us) {
  std::array<std::byte, wire::kMaxInputDatagram> plain;
  std::size_t size = 0;
  switch (player.opener.open(sealed, plain, size)) {
    case wire::SealVerdict::good:
      break;
    case wire::SealVerdict::foreign:
      ++counters_.foreign;
      return;
    case wire::SealVerdict::replayed:
      ++counters_.stale;
      return;
    case wire::SealVerdict::malformed:
    case wire::SealVerdict::forged:
      ++counters_.bad;
      return;
  }
  wire::InputDatagram input;
  if (!wire::decode_input(std::span(plain).first(size), input)) {
    ++counters_.bad;
  } else if (input.session != session_ || input.token != player.key.token) {
    ++counters_.foreign;
  } else if (player.source == nullptr || !player.source->accept(input, now_us)) {
    ++counters_.stale;
  } else {
    ++counters_.accepted;
  }
}

}  // namespace server
