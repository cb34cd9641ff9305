#include "measure.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>

#include "child.h"
#include "load.h"
#include "scene_json.h"

namespace rigid {
namespace {

constexpr double kTurn = 0.25;  // simulated time [s]
constexpr double kBusy = 10.0;  // maximum wall time of a turn, in multiples of its processor time
// An engine that stops before this fraction of the scene has no results.
constexpr double kMinShare = 0.1;

// A temporary folder, removed by the destructor.
class Scratch {
 public:
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "rigid-bench-XXXXXX").string();
    if (mkdtemp(name.data())) path_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

const EngineKind& kind_of(const std::string& option) {
  return *std::find_if(std::begin(kEngines), std::end(kEngines),
                       [&](const EngineKind& kind) { return option == kind.option; });
}

const char* option_of(const std::string& engine) {
  return std::find_if(std::begin(kEngines), std::end(kEngines),
                      [&](const EngineKind& kind) { return engine == kind.name; })
      ->option;
}

bool is_ours(std::string_view name) {
  return name.starts_with(kOurs);
}

double quantile(std::vector<double> x, double share) {
  if (x.empty()) return 0.0;
  const auto at =
      x.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(x.size() - 1));
  std::nth_element(x.begin(), at, x.end());
  return *at;
}

// The results file of a program (runner.cpp). read_left() returns nothing if it is incomplete.
struct Left {
  double simulated = 0.0, rss_mb = 0.0, fastest = -1.0;
  std::vector<double> steps;
  std::vector<vp::SE3> poses;
};
// The operator >> does not read "nan".
double read_number(std::istream& in) {
  std::string word;
  in >> word;
  return std::strtod(word.c_str(), nullptr);
}
std::optional<Left> read_left(const std::string& file, std::size_t bodies) {
  std::ifstream in(file);
  Left left;
  std::string simulated, rss, fastest, steps, poses, whole;
  std::size_t count = 0;
  in >> simulated >> left.simulated >> rss >> left.rss_mb >> fastest;
  left.fastest = read_number(in);
  in >> steps >> count;
  if (!in || simulated != "simulated" || rss != "rss_mb" || fastest != "fastest" ||
      steps != "steps")
    return {};
  for (std::size_t i = 0; i < count && in; ++i) left.steps.push_back(read_number(in));
  in >> poses >> count;
  if (!in || poses != "poses" || count != bodies) return {};
  for (std::size_t i = 0; i < count && in; ++i) {
    double x[12];
    for (double& value : x) value = read_number(in);
    left.poses.emplace_back(vp::Mat3{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}},
                            vp::Vec3{x[9], x[10], x[11]});
  }
  in >> whole;
  if (whole != "whole") return {};
  return left;
}

void summarize(Figure& figure) {
  const std::vector<double>& steps = figure.min_us.empty() ? figure.steps_us : figure.min_us;
  figure.median_us = quantile(steps, 0.5);
  figure.p99_us = quantile(figure.steps_us, 0.99);
  if (figure.ended != "finished") return;
  const auto last = static_cast<std::ptrdiff_t>(steps.size() - steps.size() / 4);
  figure.settled_us = quantile({steps.begin() + last, steps.end()}, 0.5);
}

// One scene at one rate with all engines.
class Race {
 public:
  Race(const Plan& plan, const std::string& name, int rate)
      : plan_(plan), name_(name), rate_(rate), scene_(load(name).value()) {}

  std::vector<Figure> run() {
    for (const std::string& option : plan_.engines) {
      if (is_table(name_) && !is_ours(kind_of(option).name)) continue;
      enter(kind_of(option));
    }
    while (std::any_of(entries_.begin(), entries_.end(),
                       [](const Entry& e) { return e.child.has_value(); })) {
      for (Entry& entry : entries_) {
        if (entry.child) take_turn(entry);
      }
    }
    std::vector<Figure> figures;
    for (Entry& entry : entries_) figures.push_back(std::move(entry.figure));
    compare_bits(figures);
    return figures;
  }

 private:
  struct Entry {
    Figure figure;
    std::optional<Child> child;
    std::string file;
    double budget;
  };

  double budget(const EngineKind& kind) const {
    constexpr double kOursMore = 6.0;
    const double peers = rate_ <= 60 ? plan_.seconds_at_60 : plan_.seconds;
    return is_ours(kind.name) ? kOursMore * peers : peers;
  }

  // Compares the final poses of our other builds with the native one, if both have simulated the
  // same time.
  static void compare_bits(std::vector<Figure>& figures) {
    const auto native = std::find_if(figures.begin(), figures.end(),
                                     [](const Figure& f) { return f.engine == kOurs; });
    if (native == figures.end() || native->poses.empty()) return;
    for (Figure& f : figures) {
      f.bits_as_native =
          is_ours(f.engine) && f.simulated == native->simulated && f.poses == native->poses;
    }
  }

  // The program, the scene in the format that it requires, and the arguments common to all.
  tl::expected<std::vector<std::string>, std::string> command(const EngineKind& kind,
                                                              const std::string& file) {
    const auto missing = [](const std::string& path) { return !std::filesystem::exists(path); };
    std::vector<std::string> words;
    if (!kind.node) {
      words = {plan_.programs + "/" + kind.program, name_};
      if (missing(words[0])) return tl::make_unexpected("not built: its package is missing");
    } else if (is_ours(kind.name)) {
      words = {"node", "--no-warnings", plan_.scripts + "/wasi.mjs",
               plan_.wasm + "/" + kind.program, name_};
      if (missing(words[3])) return tl::make_unexpected("not built for WebAssembly");
    } else {
      const std::string json = scratch_.file("scene.json");
      if (missing(json) && !write_json(scene_, json)) {
        return tl::make_unexpected("no room for its scene in " + json);
      }
      words = {"node", plan_.scripts + "/run.mjs", kind.program, json};
      if (missing(plan_.scripts + "/node_modules")) {
        return tl::make_unexpected("its npm package is not installed");
      }
    }
    words.insert(words.end(), {std::to_string(rate_), fmt::format("{}", budget(kind)), file});
    return words;
  }

  std::string left_out(const std::string& engine) const {
    const auto& all = plan_.left_out;
    if (const auto found = all.find(engine); found != all.end()) return found->second;
    const auto& of_joints = plan_.left_out_of_joints;
    if (scene_.joints.empty() || !of_joints.contains(engine)) return {};
    return of_joints.at(engine);
  }

  void enter(const EngineKind& kind) {
    Entry entry{{name_, kind.name, rate_}, {}, scratch_.file(kind.option), budget(kind)};
    const auto words = command(kind, entry.file);
    if (const std::string why = left_out(kind.name); !why.empty()) {
      entry.figure.missing = why;
    } else if (!words) {
      entry.figure.missing = words.error();
    } else if (auto child = Child::start(*words, plan_.log); !child) {
      entry.figure.missing = child.error();
    } else {
      const auto answer = child->receive(plan_.patience);
      if (!answer) {
        entry.figure.missing = answer.error();
      } else if (answer->word != "ready") {
        entry.figure.missing = answer->text;
      } else {
        entry.figure.settings = answer->text;
        entry.child = std::move(*child);
      }
    }
    entries_.push_back(std::move(entry));
  }

  void take_turn(Entry& entry) {
    entry.child->send(std::to_string(std::max(1L, std::lround(kTurn * rate_))));
    const auto answer = entry.child->receive(kBusy * entry.budget + plan_.patience);
    if (answer && answer->word == "more") return;
    if (!answer || answer->word != "end") {
      entry.figure.missing = answer ? answer->text : answer.error();
    } else {
      entry.figure.ended = answer->text;
      fill(entry);
      if (entry.figure.stopped() && entry.figure.simulated < kMinShare * scene_.seconds) {
        entry.figure.missing =
            fmt::format("{}, after {:.3g} s", entry.figure.ended, entry.figure.simulated);
      }
    }
    entry.child.reset();
  }

  void fill(Entry& entry) {
    Figure& figure = entry.figure;
    const auto left = read_left(entry.file, scene_.bodies.size());
    if (!left) {
      figure.missing = "what it left behind cannot be read";
      return;
    }
    figure.simulated = left->simulated;
    figure.rss_mb = left->rss_mb;
    figure.fastest = left->fastest;
    figure.standing = scenes::measure(scene_, left->poses, left->simulated);
    figure.steps_us = left->steps;
    figure.poses = left->poses;
    summarize(figure);
  }

  const Plan& plan_;
  std::string name_;
  int rate_;
  scenes::Scene scene_;
  Scratch scratch_;
  std::vector<Entry> entries_;
};

}  // namespace

double share(const Figure& a, const Figure& b) {
  const bool of_least = a.runs > 1 && a.runs == b.runs;
  const auto steps_of = [&](const Figure& f) -> const std::vector<double>& {
    return of_least ? f.min_us : f.steps_us;
  };
  const std::size_t both = std::min(steps_of(a).size(), steps_of(b).size());
  if (both == 0) return 0.0;
  const auto median = [&](const Figure& f) {
    const std::vector<double>& steps = steps_of(f);
    return quantile({steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(both)}, 0.5);
  };
  return median(b) > 0.0 ? median(a) / median(b) : 0.0;
}

namespace {

// The engines that goals compare. Either all of them run repeatedly or none: more runs give lower
// minimum times.
bool is_compared(const Figure& figure) {
  return figure.engine == kOurs || figure.engine == kReference;
}
bool is_repeated(const Plan& plan, const Figure& figure) {
  const double us = std::accumulate(figure.steps_us.begin(), figure.steps_us.end(), 0.0);
  return figure.ended == "finished" && us < 1e6 * plan.repeated_within;
}
bool did_the_same(const Figure& a, const Figure& b) {
  return a.missing.empty() && b.missing.empty() && a.ended == b.ended &&
         a.steps_us.size() == b.steps_us.size() && a.poses == b.poses;
}

void keep_least(Figure& figure, const Figure& again) {
  if (figure.min_us.empty()) figure.min_us = figure.steps_us;
  for (std::size_t i = 0; i < figure.min_us.size(); ++i) {
    figure.min_us[i] = std::min(figure.min_us[i], again.steps_us[i]);
  }
  ++figure.runs;
  summarize(figure);
}

std::vector<Figure> measure_one(const Plan& plan, const std::string& scene, int rate) {
  std::vector<Figure> figures = Race(plan, scene, rate).run();
  if (rate > 60) return figures;
  std::vector<Figure*> compared;
  Plan again = plan;
  again.engines.clear();
  again.seconds_at_60 = std::max(again.seconds_at_60, 2.0 * plan.repeated_within);
  for (Figure& figure : figures) {
    if (!is_compared(figure)) continue;
    if (!is_repeated(plan, figure)) return figures;
    compared.push_back(&figure);
    again.engines.emplace_back(option_of(figure.engine));
  }
  for (int run = 1; run < plan.runs && !compared.empty(); ++run) {
    const std::vector<Figure> others = Race(again, scene, rate).run();
    const auto same = [](const Figure* a, const Figure& b) { return did_the_same(*a, b); };
    if (!std::equal(compared.begin(), compared.end(), others.begin(), others.end(), same)) continue;
    for (std::size_t i = 0; i < compared.size(); ++i) keep_least(*compared[i], others[i]);
  }
  return figures;
}

}  // namespace

std::vector<Figure> measure(const Plan& plan, const std::function<void(const std::string&)>& said) {
  std::vector<Figure> figures;
  for (const std::string& scene : plan.scenes) {
    for (const int rate : plan.rates) {
      if (is_table(scene) && rate != 1000) continue;  // the game has one rate
      if (rate > 60 && plan.at_60_alone.contains(scene)) continue;
      said(fmt::format("{} at {} Hz", scene, rate));
      for (Figure& figure : measure_one(plan, scene, rate)) figures.push_back(std::move(figure));
    }
  }
  return figures;
}

}  // namespace rigid
