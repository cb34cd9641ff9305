#include "profile/judgment_profile.h"

#include "field_file.h"

namespace profile {

using foosball::Judgment;

tl::expected<Judgment, std::string> parse_judgment(std::string_view text, std::string_view name,
                                                   const Judgment& base) {
  return read_fields(text, name, base, foosball::kJudgmentFields, "value of judgment",
                     "space-foosball-match --list-judgment 5");
}

tl::expected<Judgment, std::string> load_judgment(const std::string& path, const Judgment& base) {
  const auto text = read_text(path, "file of a player's judgment");
  if (!text) return tl::unexpected(text.error());
  return parse_judgment(*text, path, base);
}

std::string format_judgment(const Judgment& judgment, const Judgment& base) {
  return "# Judgment of a computer player. Lines may be omitted: then the level's own value "
         "counts.\n" +
         write_fields(judgment, base, foosball::kJudgmentFields);
}

}  // namespace profile
