// Rights that a process was started with and needs no more.
#pragma once

namespace os {

// Gives up, for the calling thread and those that it makes from now on, every capability, and the
// chance to gain any by starting another program. keep_file_access: root may still write where it
// could (a file at the end of a run). False if the kernel refuses.
bool drop_capabilities(bool keep_file_access);

}  // namespace os
