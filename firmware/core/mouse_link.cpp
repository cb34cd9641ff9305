#include "core/mouse_link.h"

namespace firmware {

namespace {

const uint8_t kReset = 0xFF, kSetRate = 0xF3, kSetResolution = 0xE8, kStreamMode = 0xEA,
              kEnable = 0xF4, kReadData = 0xEB;
const uint8_t kAck = 0xFA, kResend = 0xFE, kFailed = 0xFC, kSelfTestPassed = 0xAA, kMouseId = 0x00;

const uint8_t kScript[] = {kReset, kSetRate, 200, kSetResolution, 3, kStreamMode, kEnable};
const uint8_t kAfterReset = 1;  // where the script starts for a mouse that has just reset itself
const uint8_t kGateAt = 6;
const uint8_t kScriptEnd = sizeof kScript;

bool passed(uint16_t now_ms, uint16_t deadline_ms) {
  return static_cast<int16_t>(static_cast<uint16_t>(now_ms - deadline_ms)) >= 0;
}

}  // namespace

MouseLink::Event MouseLink::other_bit(uint8_t gap, uint8_t bit, uint16_t now_ms) {
  switch (receiver_.other_bit(gap, bit)) {
    case Ps2Receiver::kNone:
      return kNone;
    case Ps2Receiver::kByte:
      return on_byte(receiver_.byte(), true, now_ms);
    case Ps2Receiver::kParityError:
      on_byte(receiver_.byte(), false, now_ms);
      return error();
    case Ps2Receiver::kFramingError:
      break;
  }
  parser_.lose();
  return error();
}

// An absent mouse has nothing to lose. Its edges may be clocks of a command that was abandoned just
// as the mouse began to receive it.
MouseLink::Event MouseLink::error() const {
  return state_ == kAbsent ? kNone : kError;
}

MouseLink::Event MouseLink::on_byte(uint8_t value, bool good, uint16_t now_ms) {
  byte_ms_ = now_ms;
  if (state_ == kStream) return on_stream_byte(value, good, now_ms);
  const uint8_t before = last_byte_;
  last_byte_ = good ? value : 0xFF;
  if (!good) return kNone;
  const bool asked = state_ == kReply || (state_ == kSend && !lines_.sending(mouse_));
  if (before == kSelfTestPassed && value == kMouseId) {
    // The end of a requested self-test, or the mouse was just plugged in and has lost its earlier
    // setup. No response to a command looks like this.
    restart();
  } else if (asked) {
    on_reply(value, now_ms);
  } else if (state_ == kBat && value == kFailed) {
    give_up(now_ms);
  }
  return kNone;
}

MouseLink::Event MouseLink::on_stream_byte(uint8_t value, bool good, uint16_t now_ms) {
  switch (parser_.byte(value, good, receiver_.after_gap())) {
    case PacketParser::kMovement:
      received_ms_ = now_ms;
      count_answer();
      return kMovement;
    case PacketParser::kResync:
      answering_ = false;
      return kResync;
    case PacketParser::kNone:
      break;
  }
  return kNone;
}

void MouseLink::count_answer() {
  if (!answering_) {
    answers_ = 0;
  } else if (movement().slide != 0 || movement().spin != 0) {
    ++answers_;
  }
  answering_ = false;
}

void MouseLink::on_reply(uint8_t value, uint16_t now_ms) {
  if (value == kAck) {
    acknowledged(now_ms);
  } else if (value == kResend || value == kFailed) {
    try_again(now_ms);
  }
}

void MouseLink::restart() {
  lines_.release(mouse_);
  present_ = false;
  asking_ = false;
  script_at_ = kAfterReset;
  tries_ = 0;
  answers_ = 0;
  begin(kScript[script_at_]);
}

void MouseLink::acknowledged(uint16_t now_ms) {
  tries_ = 0;
  answering_ = asking_;
  if (asking_) {
    stream(now_ms);
    return;
  }
  if (command_ == kReset && script_at_ == 0) {
    state_ = kBat;
    deadline_ms_ = static_cast<uint16_t>(now_ms + kBatMs);
    return;
  }
  ++script_at_;
  if (script_at_ == kScriptEnd) {
    stream(now_ms);
  } else if (script_at_ == kGateAt) {
    state_ = kGate;
  } else {
    begin(kScript[script_at_]);
  }
}

void MouseLink::stream(uint16_t now_ms) {
  asking_ = false;
  present_ = true;
  state_ = kStream;
  received_ms_ = now_ms;
  parser_.reset();
}

void MouseLink::begin(uint8_t command) {
  command_ = command;
  since_tick_ = lines_.tick();
  state_ = kPause;
}

void MouseLink::take_hold() {
  lines_.inhibit(mouse_);
  since_tick_ = lines_.tick();
  state_ = kInhibit;
}

void MouseLink::try_again(uint16_t now_ms) {
  if (++tries_ < kTries) {
    begin(command_);
  } else {
    give_up(now_ms);
  }
}

void MouseLink::give_up(uint16_t now_ms) {
  lines_.release(mouse_);
  receiver_.reset();
  state_ = kAbsent;
  present_ = false;
  asking_ = false;
  tries_ = 0;
  answers_ = 0;
  deadline_ms_ = static_cast<uint16_t>(now_ms + kRetryMs);
}

void MouseLink::send_command(uint16_t now_ms) {
  receiver_.reset();
  lines_.send(mouse_, command_);
  state_ = kSend;
  deadline_ms_ = static_cast<uint16_t>(now_ms + kSendMs);
}

MouseLink::Event MouseLink::tend_stream(uint16_t now_ms) {
  if (!parser_.between_packets()) {
    if (!passed(now_ms, static_cast<uint16_t>(byte_ms_ + kUnfinishedMs))) return kNone;
    if (parser_.looks_like_power_on()) {
      restart();
      return kNone;
    }
    parser_.expire();
    answering_ = false;
    return kResync;
  }
  if (answers_ >= kMaxAnswers) {
    restart();
    return kResync;
  }
  if (passed(now_ms, static_cast<uint16_t>(received_ms_ + kSilenceMs)) && !receiver_.busy()) {
    asking_ = true;
    command_ = kReadData;
    take_hold();
  }
  return kNone;
}

MouseLink::Event MouseLink::step(uint8_t tick, uint16_t now_ms, bool gate_open) {
  // A byte that the host's inhibit cut off is not an error.
  if (state_ != kInhibit && receiver_.sweep(tick) == Ps2Receiver::kFramingError) {
    parser_.lose();
    return error();
  }
  const uint8_t waited = static_cast<uint8_t>(tick - since_tick_);
  switch (state_) {
    case kAbsent:
      if (!passed(now_ms, deadline_ms_)) break;
      script_at_ = 0;
      begin(kScript[0]);
      break;
    case kPause:
      if (waited >= kInhibitTicks) take_hold();
      break;
    case kInhibit:
      if (waited >= kInhibitTicks) send_command(now_ms);
      break;
    case kSend:
      if (!lines_.sending(mouse_)) {
        if (!lines_.acknowledged(mouse_)) {
          try_again(now_ms);
          break;
        }
        state_ = kReply;
        deadline_ms_ = static_cast<uint16_t>(now_ms + kReplyMs);
      } else if (passed(now_ms, deadline_ms_)) {
        // A mouse that was just present may be in its self-test. If the link only requested data
        // again after that, the mouse would answer and not reveal that it has lost its setup. So it
        // is set up again.
        if (present_) {
          restart();
        } else {
          give_up(now_ms);
        }
      }
      break;
    case kReply:
      if (passed(now_ms, deadline_ms_)) try_again(now_ms);
      break;
    case kBat:
      if (passed(now_ms, deadline_ms_)) give_up(now_ms);
      break;
    case kGate:
      if (gate_open) begin(kScript[kGateAt]);
      break;
    case kStream:
      return tend_stream(now_ms);
  }
  return kNone;
}

}  // namespace firmware
