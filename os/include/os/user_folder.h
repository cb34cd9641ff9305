// Where a person's files are, as the XDG base directories have it; empty: there is no home.
#pragma once

#include <string>

namespace os {

std::string data_folder();    // $XDG_DATA_HOME, or ~/.local/share
std::string config_folder();  // $XDG_CONFIG_HOME, or ~/.config

}  // namespace os
