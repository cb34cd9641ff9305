#include "app/panel.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

#include "app/thrown.h"
#include "draw/font_files.h"
#include "scenes/catalogue.h"

namespace sandbox {
namespace {

constexpr std::array<int, 3> kRates{60, 240, 1000};  // [Hz]
constexpr std::size_t kShown = 1000;                 // number of steps in the statistics
constexpr float kMargin = 12.0f, kWidth = static_cast<float>(kPanelReach) - 2 * kMargin;  // [px]
const ImVec4 kDim{0.72f, 0.76f, 0.82f, 1.0f}, kBright{1.0f, 0.86f, 0.45f, 1.0f};
constexpr double kSlowest = 0.01, kFastest = 10.0;

bool pressed(int key) {
  return ImGui::IsKeyPressed(key, false);
}

// The scene `places` after this one in the catalogue, with wrap-around.
std::string neighbour(std::string_view name, int places) {
  const auto all = scenes::catalogue();
  const auto count = static_cast<int>(all.size());
  if (count == 0) return std::string(name);
  int at = 0;
  for (int i = 0; i < count; ++i) {
    if (all[static_cast<std::size_t>(i)].name == name) at = i;
  }
  return std::string(all[static_cast<std::size_t>((at + places + count) % count)].name);
}

void scene_chooser(const Simulation& simulation, Requests& requests) {
  ImGui::SetNextItemWidth(-1.0f);
  ImGui::PushStyleColor(ImGuiCol_Text, kBright);
  const bool open =
      ImGui::BeginCombo("##scene", simulation.scene().name.c_str(), ImGuiComboFlags_HeightLargest);
  ImGui::PopStyleColor();
  if (open) {
    for (const scenes::Entry& entry : scenes::catalogue()) {
      const std::string name(entry.name);
      if (ImGui::Selectable(name.c_str(), simulation.scene().name == name)) requests.scene = name;
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", std::string(entry.what).c_str());
    }
    ImGui::EndCombo();
  }
  ImGui::PushStyleColor(ImGuiCol_Text, kDim);
  for (const scenes::Entry& entry : scenes::catalogue()) {
    if (entry.name == simulation.scene().name)
      ImGui::TextWrapped("%s", std::string(entry.what).c_str());
  }
  ImGui::PopStyleColor();
}

void time_controls(const Simulation& simulation, const Meter& meter, Controls& controls,
                   Requests& requests) {
  if (ImGui::Button(controls.paused ? "Continue" : "Pause", {72, 0}))
    controls.paused = !controls.paused;
  ImGui::SameLine();
  if (ImGui::Button("Step", {60, 0})) requests.step = true;
  ImGui::SameLine();
  if (ImGui::Button("Restart", {92, 0})) requests.reset = true;
  ImGui::SameLine();
  ImGui::Text("%.2f s", simulation.time());
  for (const int rate : kRates) {
    char label[16];
    std::snprintf(label, sizeof label, "%d Hz", rate);
    ImGui::RadioButton(label, &controls.rate, rate);
    ImGui::SameLine();
  }
  ImGui::NewLine();
  auto speed = static_cast<float>(controls.speed);
  ImGui::SetNextItemWidth(150);
  if (ImGui::SliderFloat("##speed", &speed, static_cast<float>(kSlowest), 1.0f, "speed %.2f",
                         ImGuiSliderFlags_Logarithmic))
    controls.speed = speed;
  if (controls.paused) {
    ImGui::SameLine();
    ImGui::TextColored(kBright, "paused");
  } else if (meter.rate() > 0.0) {
    ImGui::SameLine();
    const bool behind = meter.speed() < 0.95 * controls.speed;
    ImGui::TextColored(behind ? kBright : kDim, "reached %.2f", meter.speed());
  }
}

void row(const char* what, const char* format, double value) {
  ImGui::TableNextColumn();
  ImGui::TextColored(kDim, "%s", what);
  ImGui::TableNextColumn();
  ImGui::Text(format, value);
}

void timings(const Simulation& simulation, const Meter& meter, double drawing) {
  const StepTimes::Statistics f = simulation.times().statistics(kShown);
  const std::vector<double> last = simulation.times().last(kShown);
  std::vector<float> shown(last.begin(), last.end());
  const auto top = static_cast<float>(std::max(1.25 * f.p99, 1.0));
  ImGui::PlotLines("##steps", shown.data(), static_cast<int>(shown.size()), 0, nullptr, 0.0f, top,
                   {ImGui::GetContentRegionAvail().x, 52.0f});
  ImGui::TextColored(kDim, "last %zu steps, 0 to %.0f us", shown.size(), static_cast<double>(top));
  if (ImGui::BeginTable("statistics", 4, ImGuiTableFlags_SizingStretchProp)) {
    const vp::StepCounters& counters = simulation.world().counters();
    row("median", "%.0f us", f.median);
    row("p99", "%.0f us", f.p99);
    row("bodies", "%.0f", static_cast<double>(simulation.moving()));
    row("awake", "%.0f", counters.awake);
    row("pairs", "%.0f", counters.pairs);
    row("contacts", "%.0f", counters.contacts);
    row("narrow phase", "%.0f", counters.narrow_phase_pairs);
    row("recycled", "%.0f", counters.recycled);
    row("colours", "%.0f", counters.colours);
    row("regions", "%.0f", counters.regions);
    row("sub-steps", "%.0f", counters.sub_steps);
    row("impacts", "%.0f", counters.impacts);
    row("frames", "%.0f /s", meter.rate());
    row("drawing", "%.1f ms", 1e3 * drawing);
    ImGui::EndTable();
  }
}

void stage_timings(const Simulation& simulation) {
  if (!ImGui::CollapsingHeader("Stages of a step", ImGuiTreeNodeFlags_DefaultOpen)) return;
  if (!ImGui::BeginTable("stages", 4, ImGuiTableFlags_SizingStretchProp)) return;
  for (const vp::Stage stage : vp::kStages) {
    const double us = simulation.stage_us(stage);
    if (us > 0.0) row(vp::name_of(stage), us < 1000.0 ? "%.1f us" : "%.0f us", us);
  }
  ImGui::EndTable();
}

void limits(const vp::StepStatus& status) {
  ImGui::PushTextWrapPos(0.0f);
  for (const vp::Limit limit : vp::kLimits) {
    if (reached(status, limit)) ImGui::TextColored(kBright, "%s", sentence(limit));
  }
  if (status.impact_limit) ImGui::TextColored(kBright, "%.3f s lost", status.time_lost);
  ImGui::PopTextWrapPos();
}

void show_controls(Controls& controls, Requests& requests) {
  vp::DebugDrawOptions& marks = controls.view.marks;
  if (ImGui::BeginTable("shown", 3, ImGuiTableFlags_SizingStretchSame)) {
    const auto box = [](const char* what, bool& on) {
      ImGui::TableNextColumn();
      return ImGui::Checkbox(what, &on);
    };
    if (box("contacts", marks.contacts)) marks.normals = marks.contacts;
    box("impulses", marks.impulses);
    box("frames", marks.frames);
    box("centres", marks.centres);
    box("joints", marks.joints);
    box("bounds", marks.bounds);
    box("wires", marks.shapes);
    bool by_speed = controls.view.colouring == Colouring::speed;
    if (box("speeds", by_speed))
      controls.view.colouring = by_speed ? Colouring::speed : Colouring::body;
    box("shadows", controls.view.shadows);
    ImGui::EndTable();
  }
  if (ImGui::Button("Throw a")) requests.throw_one = true;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0f);
  ImGui::Combo("##thrown", &controls.thrown, kThrownNames.data(),
               static_cast<int>(kThrownNames.size()));
  if (ImGui::Button("Show all")) requests.show_all = true;
}

void keys_help() {
  if (!ImGui::CollapsingHeader("Mouse and keys")) return;
  ImGui::TextUnformatted(
      "left: drag a body, or rotate the view\n"
      "right: pan     wheel: zoom\n"
      "Space pause    S one step    R restart\n"
      "1 2 3 rate     - + speed     N B scenes\n"
      "C contacts     I impulses    F frames\n"
      "M centres      J joints      X bounds\n"
      "W wires        V speeds      T throw\n"
      "Home show all\n"
      "Tab this panel     Esc leave");
}

}  // namespace

void read_keys(const Simulation& simulation, Controls& controls, Requests& requests) {
  if (ImGui::GetIO().WantTextInput) return;
  if (pressed(GLFW_KEY_SPACE)) controls.paused = !controls.paused;
  if (ImGui::IsKeyPressed(GLFW_KEY_S, true)) requests.step = true;
  if (pressed(GLFW_KEY_R)) requests.reset = true;
  for (std::size_t i = 0; i < kRates.size(); ++i) {
    if (pressed(GLFW_KEY_1 + static_cast<int>(i))) controls.rate = kRates[i];
  }
  if (pressed(GLFW_KEY_MINUS) || pressed(GLFW_KEY_KP_SUBTRACT))
    controls.speed = std::max(0.5 * controls.speed, kSlowest);
  if (pressed(GLFW_KEY_EQUAL) || pressed(GLFW_KEY_KP_ADD))
    controls.speed = std::min(2.0 * controls.speed, kFastest);
  if (pressed(GLFW_KEY_N)) requests.scene = neighbour(simulation.scene().name, 1);
  if (pressed(GLFW_KEY_B)) requests.scene = neighbour(simulation.scene().name, -1);
  vp::DebugDrawOptions& marks = controls.view.marks;
  if (pressed(GLFW_KEY_C)) marks.contacts = marks.normals = !marks.contacts;
  for (const auto& [key, on] : {std::pair{GLFW_KEY_I, &marks.impulses},
                                {GLFW_KEY_F, &marks.frames},
                                {GLFW_KEY_M, &marks.centres},
                                {GLFW_KEY_J, &marks.joints},
                                {GLFW_KEY_X, &marks.bounds},
                                {GLFW_KEY_W, &marks.shapes}}) {
    if (pressed(key)) *on = !*on;
  }
  if (pressed(GLFW_KEY_V)) {
    controls.view.colouring =
        controls.view.colouring == Colouring::speed ? Colouring::body : Colouring::speed;
  }
  if (pressed(GLFW_KEY_T)) requests.throw_one = true;
  if (pressed(GLFW_KEY_HOME)) requests.show_all = true;
  if (pressed(GLFW_KEY_TAB)) controls.panel = !controls.panel;
  if (pressed(GLFW_KEY_ESCAPE)) requests.leave = true;
}

void draw_panel(const Simulation& simulation, const Meter& meter, double drawing,
                const std::string& message, Controls& controls, Requests& requests) {
  if (!controls.panel) return;
  ImGui::SetNextWindowPos({kMargin, kMargin});
  ImGui::SetNextWindowSize({kWidth, 0});
  ImGui::Begin(
      "sandbox", nullptr,
      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize);
  scene_chooser(simulation, requests);
  ImGui::Separator();
  time_controls(simulation, meter, controls, requests);
  ImGui::Separator();
  timings(simulation, meter, drawing);
  stage_timings(simulation);
  ImGui::Separator();
  show_controls(controls, requests);
  keys_help();
  limits(simulation.status());
  if (!message.empty()) {
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextColored(kBright, "%s", message.c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::End();
}

tl::expected<void, std::string> style_panel(const std::string& font_directory) {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 8.0f;
  style.FrameRounding = style.GrabRounding = style.PopupRounding = 4.0f;
  style.WindowBorderSize = 0.0f;
  style.WindowPadding = {kMargin, kMargin};
  style.ItemSpacing = {8, 7};
  style.Colors[ImGuiCol_WindowBg] = {0.055f, 0.070f, 0.095f, 0.88f};
  style.Colors[ImGuiCol_PlotLines] = {0.45f, 0.80f, 0.98f, 1.0f};
  style.Colors[ImGuiCol_FrameBg] = {0.16f, 0.21f, 0.29f, 0.80f};
  style.Colors[ImGuiCol_Button] = {0.20f, 0.33f, 0.50f, 0.90f};
  for (const std::string& place : draw::font_directories(font_directory)) {
    const std::string file = place + "/DejaVuSans.ttf";
    if (std::error_code none; !std::filesystem::is_regular_file(file, none)) continue;
    if (ImGui::GetIO().Fonts->AddFontFromFileTTF(file.c_str(), 14.0f) != nullptr) return {};
  }
  return tl::unexpected(draw::no_font());
}

}  // namespace sandbox
