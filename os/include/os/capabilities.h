// Drops privileges that a process no longer needs.
#pragma once

namespace os {

// Drops every capability of the calling thread and of the threads it creates from now on, and the
// ability to gain any by executing another program. keep_file_access: root keeps its write access
// to files (a file at the end of a run). Returns false if the kernel refuses.
bool drop_capabilities(bool keep_file_access);

}  // namespace os
