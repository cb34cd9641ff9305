// Messages shared by tests, benchmarks and the fuzz corpus.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "wire/characters.h"
#include "wire/control.h"
#include "wire/device_command.h"
#include "wire/device_frame.h"
#include "wire/device_settings.h"
#include "wire/input_datagram.h"
#include "wire/journal.h"
#include "wire/phone_message.h"
#include "wire/snapshot.h"

namespace wire::samples {

using Bytes = std::vector<std::byte>;

// One of each message with every field set and no random values: their bytes are golden.
Snapshot snapshot();
InputDatagram input();
std::vector<std::pair<std::string, ControlMessage>> control();  // one of each kind, named
std::vector<JournalEntry> journal();
std::vector<CharacterRecord> characters();
DeviceFrame device_frame();
std::vector<std::pair<std::string, DeviceCommand>> device_commands();  // one of each kind, named
DeviceSettings device_settings();
std::vector<std::pair<std::string, PhoneRequest>> phone_requests();  // one of each kind, named
std::vector<std::pair<std::string, PhoneReply>> phone_replies();

// Random values within the ranges. full: every man and every event.
Snapshot random_snapshot(std::mt19937_64& random, bool full);
// Equal bit for bit, except rotations with two equally large components: either may be coded as the
// largest, and then they differ by one quantum.
bool same_but_for_ties(const Snapshot& a, const Snapshot& b);
bool same(const InputDatagram& a, const InputDatagram& b);
bool same(const ControlMessage& a, const ControlMessage& b);
bool same(const JournalEntry& a, const JournalEntry& b);
bool same(const PhoneRequest& a, const PhoneRequest& b);
bool same(const PhoneReply& a, const PhoneReply& b);

InputDatagram random_input(std::mt19937_64& random);
// 1 to kMaxCharacterCount characters, with arbitrary bits as numbers.
std::vector<CharacterRecord> random_characters(std::mt19937_64& random);
// A complete recording of this many ticks.
std::vector<JournalEntry> random_journal(std::mt19937_64& random, int ticks);

Bytes encoded(const Snapshot& snapshot);
Bytes encoded(const InputDatagram& input);
Bytes encoded(const ControlMessage& message);
Bytes encoded(const std::vector<JournalEntry>& journal);
Bytes encoded(const PhoneRequest& request);
Bytes encoded(const PhoneReply& reply);
Bytes encoded(const DeviceFrame& frame);       // the plain frame
Bytes encoded_cobs(const DeviceFrame& frame);  // as on a serial line
Bytes encoded_version_1(DeviceFrame frame);    // in the old format, without index marks
Bytes encoded(const DeviceCommand& command);
Bytes encoded(const DeviceSettings& settings);  // as a report

// Writes the correct CRC-32 at the end of a datagram, so that the checks after it are tested.
void reseal(Bytes& datagram);

std::string hex(const Bytes& bytes);
Bytes from_hex(const std::string& text);

}  // namespace wire::samples
