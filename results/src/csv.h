// A cell of a CSV file (RFC 4180).
#pragma once

#include <string>
#include <string_view>

namespace results {

// A spreadsheet interprets some initial characters as a formula: a quote before them keeps the cell
// a text.
inline std::string csv_cell(const std::string& text) {
  std::string out = text;
  if (!out.empty() && std::string_view("=+-@\t\r").find(out[0]) != std::string_view::npos) {
    out.insert(0, 1, '\'');
  }
  if (out.find_first_of(",\"\r\n") == std::string::npos) return out;
  for (std::size_t at = 0; (at = out.find('"', at)) != std::string::npos; at += 2)
    out.insert(at, 1, '"');
  return '"' + out + '"';
}

}  // namespace results
