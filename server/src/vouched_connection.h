// A connection that a port other than the control port has accepted, such as a phone's by its
// token.
#pragma once

#include "os/file_descriptor.h"
#include "os/socket_address.h"

namespace server {

struct VouchedConnection {
  os::FileDescriptor socket;              // a stream of control messages
  os::SocketAddress peer, local_address;  // remote and local address, for limits and votes
};

}  // namespace server
