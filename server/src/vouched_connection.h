// A connection that another port than the control port has let in, such as a phone's by its token.
#pragma once

#include "os/file_descriptor.h"
#include "os/socket_address.h"

namespace server {

struct VouchedConnection {
  os::FileDescriptor socket;         // a stream of control messages
  os::SocketAddress peer, heard_at;  // the other machine's, and this one's, for limits and votes
};

}  // namespace server
