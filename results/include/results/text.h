// Results as text: tables for people, CSV (RFC 4180) and JSON (RFC 8259) for programs.
#pragma once

#include <span>
#include <string>

#include "results/match_result.h"
#include "results/rating.h"

namespace results {

std::string matches_table(std::span<const MatchResult> matches);
std::string matches_csv(std::span<const MatchResult> matches);
std::string matches_json(std::span<const MatchResult> matches);

std::string standings_table(std::span<const Standing> standings);
std::string standings_csv(std::span<const Standing> standings);
std::string standings_json(std::span<const Standing> standings);

}  // namespace results
