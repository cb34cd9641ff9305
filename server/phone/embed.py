#!/usr/bin/env python3
"""Writes a page as a C++ source that defines server::phone_page().

  server/phone/embed.py PAGE.html OUT.cpp
"""
import sys
from pathlib import Path

page, out = Path(sys.argv[1]), Path(sys.argv[2])
data = page.read_bytes()
data.decode('utf-8')  # a page of other bytes ends the build here
rows = ',\n'.join(', '.join(str(byte) for byte in data[at:at + 24]) for at in range(0, len(data), 24))
out.write_text(f'''// Made by server/phone/embed.py of {page.name}.
#include "phone_page.h"

namespace server {{
namespace {{

// As bytes, for a literal may have 65536 characters at most.
constexpr unsigned char kBytes[] = {{
{rows}}};

}}  // namespace

std::string_view phone_page() {{
  return {{reinterpret_cast<const char*>(kBytes), sizeof kBytes}};
}}

}}  // namespace server
''')
