// The page that phones load: server/phone/page.html, embedded by server/phone/embed.py.
#pragma once

#include <string_view>

namespace server {

std::string_view phone_page();  // HTML in UTF-8

}  // namespace server
