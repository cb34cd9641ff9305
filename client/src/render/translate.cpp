#include "render/translate.h"

#include <libintl.h>
#include <locale.h>
#include <stdlib.h>

#include <filesystem>

// glibc's counter: incremented to report a change of the language (gettext manual, 11.2.8).
extern "C" int _nl_msg_cat_cntr;

namespace client {
namespace {

constexpr const char* kDomain = "space-foosball";
std::string catalogues, language;

// "ko_KR.UTF-8" is "ko".
std::string system_language() {
  for (const char* name : {"LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG"}) {
    const char* value = ::getenv(name);
    if (value != nullptr && value[0] != '\0') return std::string(value).substr(0, 2);
  }
  return "en";
}

}  // namespace

void use_language(const std::string& code, const std::string& directory) {
  static const std::string of_system = system_language();
  language = code.empty() ? of_system : code;
  catalogues = directory;
  // Any locale but "C" works: LANGUAGE then selects the catalogue.
  ::setlocale(LC_MESSAGES, "C.UTF-8");
  ::setenv("LANGUAGE", language.c_str(), 1);
  ::bindtextdomain(kDomain, directory.c_str());
  ::bind_textdomain_codeset(kDomain, "UTF-8");
  ++_nl_msg_cat_cntr;
}

const char* tr(const char* english) {
  return english[0] == '\0' ? english : ::dgettext(kDomain, english);
}

std::string catalogue_file() {
  const std::string file = catalogues + "/" + language + "/LC_MESSAGES/" + kDomain + ".mo";
  std::error_code error;
  return std::filesystem::is_regular_file(file, error) ? file : std::string();
}

}  // namespace client
