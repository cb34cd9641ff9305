#include "files/xml.h"

#include <algorithm>
#include <string>

namespace vp::detail {
namespace {

std::string reason(const tinyxml2::XMLDocument& document) {
  switch (document.ErrorID()) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "there is no element";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element is closed that was not the last opened, or is not closed at all";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements are nested more than 100 deep";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is not written as name=\"value\", or stands twice";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "an element is not well formed";
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
      return "a comment does not end";
    case tinyxml2::XML_ERROR_PARSING:
      return "not well-formed XML; is an element not closed?";
    default:
      return std::string("not well-formed XML (") + document.ErrorName() + ")";
  }
}

// Finds an element with more attributes than any needs, or npos: tinyxml2 compares them pairwise,
// so a million attributes in untrusted input would take hours. This function finds the same
// elements as tinyxml2, as far as tinyxml2 reads without an error.
std::size_t overfull_element(std::string_view text) {
  constexpr int kMax = 200;
  const auto after = [&](std::string_view end, std::size_t from) {
    const std::size_t at = text.find(end, from);
    return at == std::string_view::npos ? text.size() : at + end.size();
  };
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    if (text.compare(at, 4, "<!--") == 0) {
      at = after("-->", at + 4);
    } else if (text.compare(at, 9, "<![CDATA[") == 0) {
      at = after("]]>", at + 9);
    } else if (text.compare(at, 2, "<?") == 0) {
      at = after("?>", at + 2);
    } else if (text.compare(at, 2, "<!") == 0) {
      at = after(">", at + 2);
    } else {
      int attributes = 0;
      while (at < text.size() && text[at] != '>') {
        if (text[at] == '=' && ++attributes > kMax) return at;
        const bool quote = text[at] == '"' || text[at] == '\'';
        at = quote ? after(text.substr(at, 1), at + 1) : at + 1;
      }
    }
  }
  return std::string_view::npos;
}

}  // namespace

Expected<void> parse_xml(std::string_view text, tinyxml2::XMLDocument& document) {
  const auto fault = [](long line, const std::string& what) {
    return tl::make_unexpected(Error{Errc::bad_data, "line " + std::to_string(line) + ": " + what});
  };
  const auto line_at = [&](std::size_t at) {
    return 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
  };
  while (!text.empty() && text.back() == '\0') text.remove_suffix(1);
  if (const std::size_t at = text.find('\0'); at != std::string_view::npos) {
    return fault(line_at(at), "a zero byte, which no XML text has");
  }
  if (const std::size_t at = overfull_element(text); at != std::string_view::npos) {
    return fault(line_at(at), "an element with more than 200 attributes");
  }
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return fault(std::max(1, document.ErrorLineNum()), reason(document));
  }
  if (!document.RootElement()) return fault(1, "there is no element");
  return {};
}

}  // namespace vp::detail
