// The folders of a user's files, by the XDG base directory specification; empty without a home.
#pragma once

#include <string>

namespace os {

std::string data_folder();    // $XDG_DATA_HOME, or ~/.local/share
std::string config_folder();  // $XDG_CONFIG_HOME, or ~/.config

}  // namespace os
