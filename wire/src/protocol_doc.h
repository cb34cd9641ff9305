// Generates docs/protocol.md from the descriptions, from control.fbs as parsed by flatc, and from
// the head comments of wire/device_frame.h, wire/device_command.h and wire/device_settings.h.
#pragma once

#include <string>

namespace wire {

std::string protocol_document();

}  // namespace wire
