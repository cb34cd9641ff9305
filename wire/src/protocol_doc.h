// docs/protocol.md, made from the descriptions, from control.fbs as flatc understood it, and from
// the comments of wire/device_frame.h and wire/device_command.h.
#pragma once

#include <string>

namespace wire {

std::string protocol_document();

}  // namespace wire
