#include "plan.h"

#include <algorithm>
#include <cstdio>
#include <functional>

#include "match/character_study.h"
#include "match/rating.h"
#include "match/study.h"

namespace app {
namespace {

using match::log_likelihood_ratio;
using match::mean_score;
using match::pair_count;
using match::score_error;
using match::Series;
using match::SeriesDesc;

SeriesDesc base_of(const Options& o) {
  SeriesDesc desc;
  desc.players = {o.players[0], o.players[1]};
  desc.layout = o.layout;
  desc.seed = o.seed;
  desc.max_ticks = static_cast<std::uint64_t>(o.max_minutes * 60.0 / foosball::kTick);
  desc.max_games = o.matches;
  desc.tuning = o.tuning;
  desc.character_list = o.character_list;
  return desc;
}

match::ReportPlan report_plan(const Options& o) {
  const SeriesDesc base = base_of(o);
  return {o.players[0],   o.players[1], o.layout, o.seed,
          base.max_ticks, o.matches,    o.tuning, o.character_list};
}

match::StudyPlan study_plan(const Options& o) {
  return {o.players[0],     o.seed,  base_of(o).max_ticks, o.matches, o.samples,
          o.character_list, o.tuning};
}

// The same player on both sides.
SeriesDesc mirror_of(const Options& o) {
  SeriesDesc desc = base_of(o);
  desc.players[1] = desc.players[0];
  return desc;
}

std::vector<SeriesDesc> round_robin(const Options& o) {
  std::vector<SeriesDesc> all;
  for (std::size_t i = 0; i < o.players.size(); ++i) {
    for (std::size_t k = i + 1; k < o.players.size(); ++k) {
      SeriesDesc desc = base_of(o);
      desc.players = {o.players[i], o.players[k]};
      desc.max_games = o.max_matches;
      // Tests which of the two is better, with an indifference zone of half of elo1 - elo0 on
      // either side.
      const double elo = 0.5 * (o.elo1 - o.elo0);
      desc.test = {match::score_of_elo(-elo), match::score_of_elo(elo), o.alpha, o.beta};
      all.push_back(desc);
    }
  }
  return all;
}

// Limit for every pair of characters: 60:40 of the points.
constexpr double kBalanced = 0.60;

std::vector<SeriesDesc> balance(const Options& o) {
  std::vector<SeriesDesc> all;
  const int count = static_cast<int>(o.character_list.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      SeriesDesc desc = mirror_of(o);
      desc.max_games = o.max_matches;
      desc.draw_characters = false;
      desc.characters = {a, b};
      desc.band = {kBalanced, o.alpha};
      all.push_back(desc);
    }
  }
  return all;
}

std::string line(const char* format, auto... values) {
  char text[240];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string score_text(const Series& series) {
  const auto [wins, draws, losses] = series.wins_draws_losses();
  return line("%llu won, %llu drawn, %llu lost", static_cast<unsigned long long>(wins),
              static_cast<unsigned long long>(draws), static_cast<unsigned long long>(losses));
}

std::string elo_text(const Series& series) {
  const double score = mean_score(series.pairs()), error = 1.96 * score_error(series.pairs());
  const auto elo = [](double s) { return match::elo_of_score(std::clamp(s, 0.001, 0.999)) + 0.0; };
  return line("%+.0f Elo (95 %%: %+.0f to %+.0f)", elo(score), elo(score - error),
              elo(score + error));
}

void add(Results& results, const std::string& section, const std::string& name, double value,
         const std::string& unit) {
  results.figures.push_back({section, name, value, unit, "", match::Figure::Judgment::none});
}

Results of_matches(const Options& o, const Series& series) {
  Results results;
  const std::string section = o.players[0] + " against " + o.players[1];
  results.text = section + ": " + score_text(series) + "; " + elo_text(series) + "\n\n";
  results.figures = match::figures_of(section, series.statistics());
  results.text += match::as_table(results.figures);
  results.text +=
      line("\ndigest of all matches %016llx\n", static_cast<unsigned long long>(series.digest()));
  return results;
}

Results of_sprt(const Options& o, const Series& series) {
  Results results;
  const match::SequentialTest& test = *series.desc().test;
  const auto& p = series.pairs();
  const double llr = log_likelihood_ratio(p, test.score0, test.score1);
  const match::Verdict verdict = test.verdict(p);
  const std::string section = o.players[0] + " (new) against " + o.players[1] + " (old)";
  results.text = section + ": " + score_text(series) + "\n" +
                 line("pairs %llu %llu %llu %llu %llu (0 to 2 points), ",
                      static_cast<unsigned long long>(p[0]), static_cast<unsigned long long>(p[1]),
                      static_cast<unsigned long long>(p[2]), static_cast<unsigned long long>(p[3]),
                      static_cast<unsigned long long>(p[4])) +
                 elo_text(series) + "\n" +
                 line("LLR %.2f (%.2f to %.2f) of H1 %+.1f Elo against H0 %+.1f Elo: ", llr,
                      test.lower_bound(), test.upper_bound(), o.elo1, o.elo0);
  results.text += verdict == match::Verdict::h1   ? "H1, the new one is better\n"
                  : verdict == match::Verdict::h0 ? "H0, the new one is not better by so much\n"
                                                  : "not decided within --max-matches\n";
  add(results, section, "pairs", static_cast<double>(pair_count(p)), "");
  add(results, section, "score", mean_score(p), "");
  add(results, section, "LLR", llr, "");
  add(results, section, "verdict",
      verdict == match::Verdict::open ? -1 : verdict == match::Verdict::h1, "1 H1, 0 H0, -1 open");
  return results;
}

Results of_round_robin(const Options& o, const std::vector<Series>& series) {
  Results results;
  std::vector<match::Encounter> encounters;
  std::size_t next = 0;
  for (std::size_t i = 0; i < o.players.size(); ++i) {
    for (std::size_t k = i + 1; k < o.players.size(); ++k) {
      const Series& s = series[next++];
      encounters.push_back({i, k, s.pairs()});
      const match::Verdict verdict = s.verdict();
      results.text += o.players[i] + " against " + o.players[k] + ": " + score_text(s) + ", " +
                      line("%.1f %%, ", 100.0 * mean_score(s.pairs())) +
                      (verdict == match::Verdict::h1   ? o.players[i] + " is the better one\n"
                       : verdict == match::Verdict::h0 ? o.players[k] + " is the better one\n"
                                                       : "not decided\n");
      add(results, o.players[i] + " against " + o.players[k], "score", mean_score(s.pairs()), "");
    }
  }
  results.text += "\nplayer                        Elo   95 %\n";
  const auto ratings = match::rate(o.players.size(), encounters);
  for (std::size_t i = 0; i < o.players.size(); ++i) {
    results.text += line("%-26s %+6.0f   +-%.0f\n", o.players[i].c_str(), ratings[i].elo,
                         1.96 * ratings[i].error);
    add(results, "Elo", o.players[i], ratings[i].elo, "");
    add(results, "Elo, standard error", o.players[i], ratings[i].error, "");
  }
  return results;
}

// Digest of all series in order.
std::string digest_text(const std::vector<Series>& series) {
  std::uint64_t digest = 0;
  for (const Series& s : series) digest = match::mix_seed(digest ^ s.digest());
  return line("\ndigest of all matches %016llx\n", static_cast<unsigned long long>(digest));
}

// The best points by playability, and all statistics for the files.
Results of_study(const Options& o, const std::vector<Series>& series) {
  Results results;
  results.figures = match::study_figures(study_plan(o), series);
  std::vector<std::pair<double, std::string>> rows;
  std::uint64_t digest = 0;
  for (const Series& s : series) digest = match::mix_seed(digest ^ s.digest());
  for (const match::Figure& f : results.figures) {
    if (f.name == "playability") rows.emplace_back(f.value, f.section);
  }
  std::ranges::stable_sort(rows, std::greater<>(), [](const auto& row) { return row.first; });
  constexpr std::size_t kShown = 12;
  results.text =
      line("playability of %zu points and layouts, the best first; --csv has all\n", rows.size());
  for (std::size_t i = 0; i < std::min(kShown, rows.size()); ++i) {
    results.text += line("  %.3f  ", rows[i].first) + rows[i].second + "\n";
  }
  results.text +=
      line("\ndigest of all matches %016llx\n", static_cast<unsigned long long>(digest));
  return results;
}

const char* word(match::Verdict verdict) {
  return verdict == match::Verdict::h0   ? "within 60:40"
         : verdict == match::Verdict::h1 ? "beyond 60:40"
                                         : "not decided";
}

// One column per character: the points of the row's character against it [%].
std::string cross_table(const foosball::Characters& characters, const std::vector<Series>& series) {
  const std::size_t n = characters.size();
  std::string text = line("\n  %-24s", "");
  for (std::size_t c = 0; c < n; ++c) text += line(" %6zu", c + 1);
  text += "    all\n";
  const auto score = [&](std::size_t a, std::size_t b) {
    for (const Series& s : series) {
      const auto& c = s.desc().characters;
      const auto row = static_cast<std::size_t>(c[0]), column = static_cast<std::size_t>(c[1]);
      if (row == a && column == b) return 100.0 * mean_score(s.pairs());
      if (row == b && column == a) return 100.0 - 100.0 * mean_score(s.pairs());
    }
    return 50.0;
  };
  for (std::size_t a = 0; a < n; ++a) {
    text += line("  %zu %-22s", a + 1, characters[a].name.c_str());
    double sum = 0.0;
    for (std::size_t b = 0; b < n; ++b) {
      text += a == b ? line(" %6s", "-") : line(" %6.1f", score(a, b));
      sum += a == b ? 0.0 : score(a, b);
    }
    text += n > 1 ? line(" %6.1f\n", sum / static_cast<double>(n - 1)) : "\n";
  }
  return text;
}

Results of_balance(const Options& o, const std::vector<Series>& series) {
  Results results;
  const foosball::Characters& characters = o.character_list;
  results.text =
      "characters, both sides played by " + o.players[0] +
      (o.layout == foosball::Layout::paper ? ", paper layout\n" : ", tournament layout\n");
  int decided = 0, within = 0;
  for (const Series& s : series) {
    const auto& c = s.desc().characters;
    const std::string name = characters[static_cast<std::size_t>(c[0])].name + " against " +
                             characters[static_cast<std::size_t>(c[1])].name;
    const match::Verdict verdict = s.verdict();
    results.text += line("  %-34s %5.1f %% +-%.1f  %5llu matches  %s\n", name.c_str(),
                         100.0 * mean_score(s.pairs()), 196.0 * score_error(s.pairs()),
                         static_cast<unsigned long long>(s.taken()), word(verdict));
    decided += verdict != match::Verdict::open;
    within += verdict == match::Verdict::h0;
    const auto judgment = verdict == match::Verdict::h0   ? match::Figure::Judgment::pass
                          : verdict == match::Verdict::h1 ? match::Figure::Judgment::falls_short
                                                          : match::Figure::Judgment::open;
    results.figures.push_back(
        {"balance", name, 100.0 * mean_score(s.pairs()), "% points", "40 to 60", judgment});
  }
  results.text += cross_table(characters, series);
  results.text += line("\n%d of %zu pairs within 60:40, %d beyond, %d not decided\n", within,
                       series.size(), decided - within, static_cast<int>(series.size()) - decided);
  return results;
}

}  // namespace

match::TrainPlan train_plan(const Options& o) {
  match::TrainPlan plan = o.training;
  plan.base = base_of(o);
  return plan;
}

std::vector<SeriesDesc> series_of(const Options& o) {
  SeriesDesc desc = base_of(o);
  switch (o.mode) {
    case Mode::matches:
      return {desc};
    case Mode::report:
      return match::report_series(report_plan(o));
    case Mode::stuck_balls:
      return match::stuck_ball_series(report_plan(o));
    case Mode::sprt:
      desc.max_games = o.max_matches;
      desc.test = {match::score_of_elo(o.elo0), match::score_of_elo(o.elo1), o.alpha, o.beta};
      return {desc};
    case Mode::round_robin:
      return round_robin(o);
    case Mode::balance:
      return balance(o);
    case Mode::study:
      return match::study_series(study_plan(o));
    case Mode::vary:
      return match::varied_series(mirror_of(o), o.varied);
    case Mode::traits:
      return match::trait_series(mirror_of(o));
    case Mode::screen:
      return match::screen_series(train_plan(o));
    case Mode::train:
      return match::Training(train_plan(o)).round();
  }
  return {};
}

Results results_of(const Options& o, const std::vector<Series>& series) {
  switch (o.mode) {
    case Mode::matches:
      return of_matches(o, series[0]);
    case Mode::report: {
      Results results;
      results.figures = match::report_figures(report_plan(o), series);
      results.text = match::as_table(results.figures);
      return results;
    }
    case Mode::stuck_balls: {
      Results results;
      results.figures = match::stuck_ball_figures(series);
      results.text = match::as_table(results.figures) + digest_text(series);
      results.falls_short = match::any_short(results.figures);
      return results;
    }
    case Mode::sprt:
      return of_sprt(o, series[0]);
    case Mode::round_robin:
      return of_round_robin(o, series);
    case Mode::balance:
      return of_balance(o, series);
    case Mode::study:
      return of_study(o, series);
    case Mode::vary: {
      Results results;
      results.figures = match::varied_figures(o.varied, series);
      results.text = match::as_table(results.figures);
      return results;
    }
    case Mode::traits:
      return {match::trait_table(series), match::trait_figures(series)};
    case Mode::screen: {
      Results results;
      results.figures = match::screen_figures(train_plan(o), series);
      results.text = match::as_table(results.figures) + digest_text(series);
      return results;
    }
    case Mode::train:
      break;  // has rounds: results_of_training()
  }
  return {};
}

Results results_of_training(const match::Training& training, const std::vector<Series>& series) {
  Results results;
  results.figures = training.figures();
  results.text = match::as_table(results.figures) + digest_text(series);
  return results;
}

}  // namespace app
