#include "core/gamepads.h"

namespace firmware {

namespace {

const int16_t kFull = 32767;  // of an axis, in either direction
const uint32_t kOne = 65536;  // fixed-point one of a factor

// By player: goalkeeper and defence of team 0, midfield and attack, and the same of team 1.
const uint8_t kLeftRod[kPads] = {0, 3, 7, 4}, kRightRod[kPads] = {1, 5, 6, 2};

// The tournament table: travel from stop to stop, and circumference of a rod of 16 mm.
const uint16_t kTravelMm[wire::kDeviceRods] = {540, 393, 252, 152, 152, 252, 393, 540};
const uint8_t kAroundMm = 50;

uint16_t counts_on(uint16_t mm, uint16_t counts_per_cm) {
  const uint32_t counts = static_cast<uint32_t>(mm) * counts_per_cm / 10;
  if (counts < wire::kMinStickCounts) return wire::kMinStickCounts;
  return counts > 0xFFFF ? 0xFFFF : static_cast<uint16_t>(counts);
}

int16_t scaled(uint16_t counts, uint32_t factor) {
  return static_cast<int16_t>(counts * factor / kOne);
}

int16_t difference(uint16_t from, uint16_t to, bool reversed) {
  return static_cast<int16_t>(reversed ? from - to : to - from);
}

}  // namespace

uint8_t Gamepads::left_rod(uint8_t pad) {
  return kLeftRod[pad];
}
uint8_t Gamepads::right_rod(uint8_t pad) {
  return kRightRod[pad];
}

void Gamepads::begin() {
  forget_host();
  for (Stick& stick : sticks_) {
    stick.begun = false;
    middle(stick);
  }
}

void Gamepads::middle(Stick& stick) {
  stick.at = stick.travel / 2;
  stick.angle = 0;
  stick.window_spin = 0;
  stick.windows_held = 0;
}

void Gamepads::scale(uint8_t rod, const wire::DeviceSettings& settings, uint16_t counts_per_cm) {
  const wire::StickScale& wanted = settings.sticks[rod];
  Stick& stick = sticks_[rod];
  stick.slide_reversed = (settings.slide_reversed >> rod & 1) != 0;
  stick.spin_reversed = (settings.spin_reversed >> rod & 1) != 0;
  const uint16_t travel =
      wanted.travel != 0 ? wanted.travel : counts_on(kTravelMm[rod], counts_per_cm);
  const uint16_t turn = wanted.turn != 0 ? wanted.turn : counts_on(kAroundMm, counts_per_cm);
  if (travel == stick.travel && turn == stick.turn) return;  // a division takes an AVR 40 us
  stick.travel = travel;
  stick.turn = turn;
  stick.slide_factor = 2 * kOne * kFull / travel;
  stick.spin_factor = kOne * kFull / (turn / 4);
  middle(stick);
}

void Gamepads::move(uint8_t rod, uint16_t slide, uint16_t spin, uint16_t now_ms) {
  Stick& stick = sticks_[rod];
  const int16_t slid = difference(stick.slide_before, slide, stick.slide_reversed);
  const int16_t spun = difference(stick.spin_before, spin, stick.spin_reversed);
  stick.slide_before = slide;
  stick.spin_before = spin;
  if (!stick.begun || stick.travel == 0) {
    stick.begun = true;
    stick.moved_ms = now_ms;
    return;
  }
  const int32_t at = static_cast<int32_t>(stick.at) + slid;
  stick.at = at < 0 ? 0 : at > stick.travel ? stick.travel : static_cast<uint16_t>(at);
  if (slid != 0) stick.moved_ms = now_ms;
  spin_by(stick, spun, now_ms);
  look_for_fast_turn(stick, spun, now_ms);
}

void Gamepads::spin_by(Stick& stick, int16_t counts, uint16_t now_ms) {
  if (counts != 0) {
    stick.moved_ms = now_ms;
    int32_t angle = static_cast<int32_t>(stick.angle) + counts;
    while (angle < 0) angle += stick.turn;
    while (angle >= stick.turn) angle -= stick.turn;
    stick.angle = static_cast<uint16_t>(angle);
  } else if (static_cast<uint16_t>(now_ms - stick.moved_ms) >= kLetGoMs) {
    stick.angle = 0;
  }
}

void Gamepads::look_for_fast_turn(Stick& stick, int16_t counts, uint16_t now_ms) {
  stick.window_spin = static_cast<int16_t>(stick.window_spin + counts);
  if (static_cast<uint8_t>(static_cast<uint8_t>(now_ms) - stick.window_ms) < kWindowMs) return;
  stick.window_ms = static_cast<uint8_t>(now_ms);
  const uint16_t sum = static_cast<uint16_t>(stick.window_spin);
  const uint16_t turned = stick.window_spin < 0 ? static_cast<uint16_t>(0 - sum) : sum;
  stick.window_spin = 0;
  if (turned >= stick.turn / 16) {
    stick.windows_held = kWindowsHeld;
  } else if (stick.windows_held != 0) {
    --stick.windows_held;
  }
}

int16_t Gamepads::axis_of_slide(const Stick& stick) {
  if (stick.at >= stick.travel) return static_cast<int16_t>(-kFull);
  const uint16_t from_near = static_cast<uint16_t>(stick.at * stick.slide_factor / kOne);
  return static_cast<int16_t>(static_cast<int32_t>(kFull) - from_near);
}

int16_t Gamepads::axis_of_spin(const Stick& stick) {
  const uint16_t half = stick.turn / 2, quarter = stick.turn / 4;
  const bool left = stick.angle > half;
  uint16_t angle = left ? static_cast<uint16_t>(stick.turn - stick.angle) : stick.angle;
  if (angle > quarter) angle = static_cast<uint16_t>(half - angle);
  const int16_t axis = angle >= quarter ? kFull : scaled(angle, stick.spin_factor);
  return left ? static_cast<int16_t>(-axis) : axis;
}

const uint8_t* Gamepads::report(uint8_t pad) {
  const Stick& left = sticks_[left_rod(pad)];
  const Stick& right = sticks_[right_rod(pad)];
  const uint16_t values[kPadBytes / 2] = {
      static_cast<uint16_t>(axis_of_spin(left)), static_cast<uint16_t>(axis_of_slide(left)),
      static_cast<uint16_t>(axis_of_spin(right)), static_cast<uint16_t>(axis_of_slide(right)),
      static_cast<uint16_t>((left.windows_held != 0 ? 1 : 0) | (right.windows_held != 0 ? 2 : 0))};
  const uint8_t bit = static_cast<uint8_t>(1u << pad);
  bool news = (told_ & bit) == 0;
  uint8_t* out = reports_[pad];
  for (uint8_t i = 0; i < kPadBytes / 2; ++i, out += 2) {
    if (wire::device_get16(out) == values[i]) continue;
    wire::device_put16(out, values[i]);
    news = true;
  }
  told_ = static_cast<uint8_t>(told_ | bit);
  return news ? reports_[pad] : nullptr;
}

}  // namespace firmware
