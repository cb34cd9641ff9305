// docs/protocol.md, made from the descriptions, from control.fbs as flatc understood it, and from
// the comment and the encoder of wire/device_frame.h.
#pragma once

#include <string>

namespace wire {

std::string protocol_document();

}  // namespace wire
