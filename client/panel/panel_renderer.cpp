// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/panel/panel_renderer.hpp"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/hud/text_box.hpp"
#include "client/text/catalogue.hpp"

namespace eti::panel {
namespace {

using text::translate;
using text::translate_format;

constexpr int least_text = 13;  // pixels
constexpr int across = 27;      // text heights
// On-screen keyboard for parameter names, as a laser pointer has no keys. Layout as on telephones.
constexpr std::array<std::string_view, 3> key_rows = {"qwertyuiop", "asdfghjkl", "zxcvbnm"};
constexpr float key_height = 2.0f;    // text heights; at 0.9 m, 2.5 deg
constexpr float old_opacity = 0.45f;  // of outdated values

ImVec4 colour(ImU32 packed) {
    return ImGui::ColorConvertU32ToFloat4(packed);
}

void put(std::string_view words, ImU32 in = hud::white) {
    ImGui::PushStyleColor(ImGuiCol_Text, in);
    ImGui::TextUnformatted(words.data(), words.data() + words.size());
    ImGui::PopStyleColor();
}

void wrapped(std::string_view words, ImU32 in) {
    ImGui::PushTextWrapPos(0.0f);
    put(words, in);
    ImGui::PopTextWrapPos();
}

// On the current line, right-aligned.
void at_right(const std::string& words, ImU32 in) {
    ImGui::SameLine();
    const float left = ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(words.c_str()).x;
    ImGui::SetCursorPosX(std::max(left, ImGui::GetCursorPosX()));
    put(words, in);
}

// Dear ImGui's identity of a control stays when its text changes.
std::string labelled(std::string_view english) {
    return fmt::format("{}###{}", translate(english), english);
}

// Puts the next button beside the last one if there is room for its translation.
void beside(std::string_view english) {
    ImGui::SameLine();
    const std::string words(translate(english));
    const float wide = ImGui::CalcTextSize(words.c_str()).x + 2.0f * ImGui::GetStyle().FramePadding.x;
    if (ImGui::GetContentRegionAvail().x < wide) {
        ImGui::NewLine();
    }
}

// `english`: translated here.
void explain(std::string_view english) {
    if (ImGui::IsItemHovered()) {
        const std::string_view words = translate(english);
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(20.0f * ImGui::GetFontSize());
        ImGui::TextUnformatted(words.data(), words.data() + words.size());
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }
}

// Dear ImGui format string: a per cent sign is doubled.
std::string number_format(const ParameterRow& row) {
    std::string unit;
    for (const char letter : row.unit) {
        unit += letter == '%' ? "%%" : std::string(1, letter);
    }
    const float range = row.high - row.low;
    const int digits = range >= 100.0f ? 0 : range >= 10.0f ? 1 : 2;
    return fmt::format("%.{}f{}{}", digits, unit.empty() ? "" : " ", unit);
}

void draw_series(const Series& series, double newest_s, ImVec2 size) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 end(corner.x + size.x, corner.y + size.y);
    ImGui::SetCursorScreenPos(ImVec2(corner.x, end.y + ImGui::GetStyle().ItemSpacing.y));
    const float high = series.high(), low = series.low();
    const auto y_of = [&](float value) {
        return end.y - size.y * std::clamp((value - low) / (high - low), 0.0f, 1.0f);
    };
    const float opacity = ImGui::GetStyle().Alpha;
    const auto faded = [&](ImU32 packed, float share) {
        ImVec4 out = colour(packed);
        out.w *= share * opacity;
        return ImGui::ColorConvertFloat4ToU32(out);
    };
    list.AddRectFilled(corner, end, faded(IM_COL32(30, 36, 40, 255), 1.0f));
    for (const double second : {15.0, 30.0, 45.0}) {
        const float x = end.x - size.x * static_cast<float>(second / History::span_s);
        list.AddLine(ImVec2(x, corner.y), ImVec2(x, end.y), faded(hud::grey, 0.2f));
    }
    for (const auto& [limit, in] : {std::pair{0.0f, hud::grey}, std::pair{series.field->warning, hud::amber},
                                    std::pair{series.field->bad, hud::red}}) {
        if (limit >= low && limit < high) {  // false for NaN
            list.AddLine(ImVec2(corner.x, y_of(limit)), ImVec2(end.x, y_of(limit)), faded(in, 0.6f));
        }
    }
    std::vector<ImVec2> points;
    for (const Series::Sample& sample : series.samples) {
        const auto age = static_cast<float>((newest_s - sample.time_s) / History::span_s);
        points.emplace_back(end.x - size.x * age, y_of(sample.value));
    }
    list.AddPolyline(points.data(), static_cast<int>(points.size()), faded(hud::white, 1.0f), 0,
                     std::max(1.0f, 0.1f * ImGui::GetFontSize()));
}

}  // namespace

int text_height(int height, float text_scale) {
    return static_cast<int>(
        std::lround(text_scale * static_cast<float>(std::max(least_text, (height + 49) / 50))));
}

Area panel_area(int width, int height, float text_scale) {
    const int wide = across * text_height(height, text_scale);
    if (wide <= width * 45 / 100) {
        return {width - wide, 0, wide, height};
    }
    const int high = height / 2;
    return {0, height - high, width, high};
}

Area scene_area(int width, int height, float text_scale) {
    const Area panel = panel_area(width, height, text_scale);
    return panel.x > 0 ? Area{0, 0, panel.x, height} : Area{0, 0, width, panel.y};
}

PanelRenderer::PanelRenderer(GLFWwindow* window, float text_scale) : text_scale_(text_scale) {
    if (window != nullptr) {
        canvas_.attach(window);
    }
}

void PanelRenderer::set_pointer(const Pointer& pointer) {
    const Canvas::ContextScope use(canvas_);
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(pointer.x, pointer.y);
    io.MouseDown[0] = pointer.down;
    io.MouseWheel += pointer.wheel;
}

void PanelRenderer::discard_input() {
    const Canvas::ContextScope use(canvas_);
    ImGui::GetIO().ClearInputCharacters();
    ImGui::GetIO().MouseWheel = 0.0f;
}

void PanelRenderer::draw(Model& model, int width, int height, Model::Time now) {
    draw_into(panel_area(width, height, text_scale_), text_height(height, text_scale_), model, width, height,
              now);
}

void PanelRenderer::draw_full_screen(Model& model, int width, int height, Model::Time now) {
    shows_pointer_ = true;
    draw_into({0, 0, width, height}, std::max(least_text, width / across), model, width, height, now);
}

void PanelRenderer::draw_into(const Area& area, int letters, Model& model, int width, int height,
                              Model::Time now) {
    const Canvas::ContextScope use(canvas_);
    const float seconds = last_ ? std::chrono::duration<float>(now - *last_).count() : 0.0f;
    last_ = now;
    canvas_.begin(width, height, letters, std::max(seconds, 1e-3f));
    places_.clear();
    ImGui::SetNextWindowPos(ImVec2(static_cast<float>(area.x), static_cast<float>(area.y)));
    ImGui::SetNextWindowSize(ImVec2(static_cast<float>(area.width), static_cast<float>(area.height)));
    if (focus_keyboard_) {
        ImGui::SetNextWindowFocus();
    }
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing);
    const bool appears = ImGui::IsWindowAppearing();
    // Esc first closes what it applies to; then it leaves the panel and returns the keys to the window.
    if (ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows) && !ImGui::IsAnyItemActive() &&
        held_.empty() && !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId) &&
        ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) {
        ImGui::SetWindowFocus(nullptr);
    }
    draw_head(model, now);
    ImGui::PushStyleVar(ImGuiStyleVar_Alpha, model.stale(now) ? old_opacity : 1.0f);
    draw_page(model);
    ImGui::PopStyleVar();
    ImGui::End();
    if (appears && !focus_keyboard_) {
        ImGui::SetWindowFocus(nullptr);  // otherwise the panel's content would capture the keyboard
    }
    focus_keyboard_ = false;
    const ImGuiIO& io = ImGui::GetIO();
    has_mouse_ = io.WantCaptureMouse;
    has_keyboard_ = io.WantCaptureKeyboard;
    has_text_ = io.WantTextInput;
    if (shows_pointer_ && ImGui::IsMousePosValid()) {
        const float radius = 0.35f * ImGui::GetFontSize();
        ImGui::GetForegroundDrawList()->AddCircleFilled(io.MousePos, radius, hud::white);
        ImGui::GetForegroundDrawList()->AddCircle(io.MousePos, radius, IM_COL32(8, 12, 14, 255), 0, 2.0f);
    }
    canvas_.end();
}

void PanelRenderer::record_place(std::string_view control) {
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    if (ImGui::IsItemVisible()) {
        places_[std::string(control)] = {static_cast<int>(low.x), static_cast<int>(low.y),
                                         static_cast<int>(high.x - low.x), static_cast<int>(high.y - low.y)};
    }
}

std::optional<Area> PanelRenderer::place(std::string_view control) const {
    const auto found = places_.find(control);
    return found == places_.end() ? std::nullopt : std::optional(found->second);
}

bool PanelRenderer::button(const std::string& words) {
    const bool pressed = ImGui::Button(labelled(words).c_str());
    record_place(words);
    return pressed;
}

void PanelRenderer::draw_head(const Model& model, Model::Time now) {
    const Model::Session& session = model.session();
    const std::string watching(translate("watching only"));
    // Lines wrap before the right-aligned text.
    ImGui::PushTextWrapPos(
        ImGui::GetContentRegionMax().x -
        (model.commands() ? 0.0f : ImGui::CalcTextSize(watching.c_str()).x + ImGui::GetFontSize()));
    put(session.scenario.empty() ? translate("no session yet") : session.scenario);
    ImGui::PopTextWrapPos();
    if (!model.commands()) {
        at_right(watching, hud::grey);
    }
    if (model.stale(now)) {
        put(model.silent_s(now) > 0.0 ? translate_format("no data for {:.0f} s", model.silent_s(now))
                                      : std::string(translate("no server found")),
            hud::red);
    } else {
        put(fmt::format("{}, {:.1f} s", translate(session.phase), session.time_s), hud::grey);
    }
    at_right(session.attempt == 0      ? std::string(translate("no attempt yet"))
             : session.attempt_running ? translate_format("attempt {}", session.attempt)
                                       : translate_format("attempt {} ended", session.attempt),
             session.attempt_running ? hud::green : hud::grey);
}

void PanelRenderer::draw_page(Model& model) {
    if (!ImGui::BeginTabBar("pages")) {
        return;
    }
    // The model changed the page, not the user.
    const bool turned = drawn_page_ != model.page;
    std::optional<Page> shown;
    for (const Page page : pages) {
        const std::string name(title(page));
        const bool open =
            ImGui::BeginTabItem(labelled(name).c_str(), nullptr,
                                turned && page == model.page ? ImGuiTabItemFlags_SetSelected : 0);
        record_place(name);
        if (!open) {
            continue;
        }
        shown = page;
        shows_keyboard_ = shows_keyboard_ && page == Page::patient;
        // Arrow keys move through the tabs and the page alike.
        ImGui::BeginChild("page", ImVec2(0.0f, shows_keyboard_ ? -keyboard_height() : 0.0f), false,
                          ImGuiWindowFlags_NavFlattened);
        ImGui::PushItemWidth(-1.0f);
        switch (page) {
            case Page::patient:
                draw_patient(model);
                break;
            case Page::aids:
                draw_aids(model);
                break;
            case Page::session:
                draw_session(model);
                break;
            case Page::plots:
                draw_plots(model);
                break;
            case Page::health:
                draw_health(model);
                break;
        }
        ImGui::PopItemWidth();
        ImGui::EndChild();
        if (shows_keyboard_) {
            draw_keyboard(model.search);
        }
        ImGui::EndTabItem();
    }
    ImGui::EndTabBar();
    if (!turned) {
        model.page = shown.value_or(model.page);
    }
    drawn_page_ = model.page;
}

void PanelRenderer::draw_patient(Model& model) {
    if (focus_keyboard_) {
        ImGui::SetKeyboardFocusHere();  // after showing the panel by a key the user can type a search at
                                        // once
    }
    ImGui::InputTextWithHint("##search", translate("search").data(), &model.search);
    record_place("search");
    shows_keyboard_ = shows_keyboard_ || (shows_pointer_ && ImGui::IsItemActivated());
    if (model.search.empty()) {
        draw_presets(model);
        draw_group(model, Group::published, text::translatable("As in the paper"));
        draw_group(model, Group::other, text::translatable("More"));
        return;
    }
    for (std::size_t i = 0; i < model.rows().size(); ++i) {
        if (matches(model.rows()[i], model.search)) {
            draw_slider(model, i);
        }
    }
}

float PanelRenderer::keyboard_height() const {
    const auto rows = static_cast<float>(key_rows.size() + 1);
    return rows * (key_height * ImGui::GetFontSize() + ImGui::GetStyle().ItemSpacing.y);
}

void PanelRenderer::draw_keyboard(std::string& typed) {
    const float gap = ImGui::GetStyle().ItemSpacing.x, high = key_height * ImGui::GetFontSize();
    const float left = ImGui::GetCursorPosX(), room = ImGui::GetContentRegionAvail().x + gap;
    const float wide = room / static_cast<float>(key_rows.front().size());
    const auto key = [&](const std::string& words, float keys) {
        const bool pressed = ImGui::Button(fmt::format("{}###key {}", translate(words), words).c_str(),
                                           ImVec2(keys * wide - gap, high));
        record_place("key " + words);
        return pressed;
    };
    for (std::size_t row = 0; row < key_rows.size(); ++row) {
        ImGui::SetCursorPosX(left + 0.5f * static_cast<float>(row) * wide);
        for (const char letter : key_rows[row]) {
            if (key(std::string(1, letter), 1.0f)) {
                typed += letter;
            }
            ImGui::SameLine();
        }
        ImGui::NewLine();
    }
    if (key(std::string(text::translatable("clear")), 2.0f)) {
        typed.clear();
    }
    ImGui::SameLine();
    if (key(std::string(text::translatable("space")), 4.0f)) {
        typed += ' ';
    }
    ImGui::SameLine();
    if (key(std::string(text::translatable("back")), 2.0f) && !typed.empty()) {
        typed.pop_back();
    }
    ImGui::SameLine();
    shows_keyboard_ = !key(std::string(text::translatable("done")), 2.0f);
}

void PanelRenderer::draw_presets(Model& model) {
    if (!model.commands()) {
        return;
    }
    const Preset* const chosen = model.chosen();
    const bool open = ImGui::BeginCombo(
        "##preset", chosen != nullptr ? translate(chosen->name).data() : translate("difficulty ...").data());
    record_place("preset");
    if (open) {
        for (const Preset& preset : model.presets().all) {
            if (ImGui::Selectable(labelled(preset.name).c_str(), &preset == chosen)) {
                model.request(preset);
            }
            record_place("preset " + preset.name);
            explain(preset.description);
        }
        for (const std::string& error : model.presets().errors) {
            wrapped(error, hud::red);
        }
        ImGui::EndCombo();
    }
    if (chosen != nullptr) {
        wrapped(translate(chosen->description), hud::grey);
    }
}

void PanelRenderer::draw_group(Model& model, Group group, std::string_view heading) {
    put(translate(heading), hud::grey);
    if (model.commands()) {
        ImGui::SameLine();
        const std::string reset(translate("reset all"));
        const std::string label = fmt::format("{}###reset {}", reset, heading);
        ImGui::SetCursorPosX(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(reset.c_str()).x -
                             2.0f * ImGui::GetStyle().FramePadding.x);
        if (ImGui::SmallButton(label.c_str())) {
            model.request_initial_values(group);
        }
        record_place("start of " + std::string(heading));
    }
    for (std::size_t i = 0; i < model.rows().size(); ++i) {
        if (model.rows()[i].group == group) {
            draw_slider(model, i);
        }
    }
}

void PanelRenderer::draw_slider(Model& model, std::size_t i) {
    const ParameterRow& row = model.rows()[i];
    ImGui::PushID(row.name.c_str());
    put(translate(row.label), row.now ? hud::white : hud::grey);
    if (row.wanted) {
        at_right(fmt::format("\u2192 {}", format_value(row, *row.wanted)), hud::amber);
    } else {
        at_right(translate_format(
                     "{:g} to {}", row.low,
                     row.on_off ? std::string(translate("on")) : fmt::format("{:g} {}", row.high, row.unit)),
                 hud::grey);
    }
    // While held, the slider shows the user's value; otherwise the server's.
    const float from = row.now.value_or(row.start);
    float value = held_ == row.name ? typed_.value_or(row.wanted.value_or(from)) : from;
    const float reset_wide = 6.2f * ImGui::GetFontSize();
    ImGui::BeginDisabled(!model.commands());
    ImGui::SetNextItemWidth(-reset_wide - ImGui::GetStyle().ItemSpacing.x);
    const std::string format = number_format(row);
    ImGui::SliderFloat("##value", &value, row.low, row.high, format.c_str(),
                       ImGuiSliderFlags_AlwaysClamp | (row.relative ? ImGuiSliderFlags_Logarithmic : 0));
    record_place(row.name);
    const bool held = ImGui::IsItemActive(), left = ImGui::IsItemDeactivated();
    explain(row.help);
    if (held && has_text_) {
        typed_ = value;  // incomplete numbers are not requested
    } else if ((held || left) && value != row.wanted.value_or(from)) {
        model.request(i, value);
    }
    if (held) {
        held_ = row.name;
    } else if (held_ == row.name) {
        held_.clear();
        typed_.reset();
    }
    ImGui::SameLine();
    if (ImGui::Button(format_value(row, row.start).c_str(), ImVec2(reset_wide, 0.0f))) {
        model.request(i, row.start);
    }
    record_place("start of " + row.name);
    explain(text::translatable("reset to the value at the start of the session"));
    ImGui::EndDisabled();
    if (!row.refusal.empty()) {
        wrapped(row.refusal, hud::red);
    }
    ImGui::PopID();
}

void PanelRenderer::draw_aids(Model& model) {
    for (std::size_t i = 0; i < model.rows().size(); ++i) {
        const ParameterRow& row = model.rows()[i];
        if (row.group != Group::aids) {
            continue;
        }
        ImGui::PushID(row.name.c_str());
        bool on = row.now.value_or(row.start) > 0.5f;
        ImGui::BeginDisabled(!model.commands());
        if (ImGui::Checkbox(labelled(row.label).c_str(), &on)) {
            model.request(i, on ? 1.0f : 0.0f);
        }
        record_place(row.name);
        ImGui::EndDisabled();
        if (row.wanted) {
            at_right(fmt::format("\u2192 {}", format_value(row, *row.wanted)), hud::amber);
        }
        wrapped(translate(row.help), hud::grey);
        if (!row.refusal.empty()) {
            wrapped(row.refusal, hud::red);
        }
        ImGui::PopID();
    }
}

void PanelRenderer::draw_session(Model& model) {
    wrapped(translate(model.session().description), hud::grey);
    if (model.commands()) {
        ImGui::Spacing();
        if (button(std::string(text::translatable("Start")))) {
            model.request("start");
        }
        explain(text::translatable("Checks that the session runs; it does from the server's start"));
        beside("Reset");
        if (button(std::string(text::translatable("Reset")))) {
            model.request("reset");
        }
        explain(text::translatable("Resets tissue and tube; time and attempts continue"));
        beside("Next scenario");
        if (button(std::string(text::translatable("Next scenario")))) {
            model.request("next");
        }
        explain(text::translatable(
            "Ends this session and starts the next, if the server was given several scenarios"));
        beside("Stop ...");
        confirming_stop_ =
            button(std::string(text::translatable("Stop ..."))) ? !confirming_stop_ : confirming_stop_;
        if (confirming_stop_) {
            wrapped(translate("Ends the session; the server completes the recording."), hud::amber);
            if (button(std::string(text::translatable("Stop the session")))) {
                confirming_stop_ = false;
                model.request("stop");
            }
            beside("Cancel");
            confirming_stop_ = !button(std::string(text::translatable("Cancel"))) && confirming_stop_;
        }
    }
    if (!model.refusal().empty()) {
        wrapped(model.refusal(), hud::red);
    }
}

void PanelRenderer::draw_plots(const Model& model) {
    std::vector<const Series*> all;
    for (const Series& series : model.history().series()) {
        if (!series.field->optional || !series.samples.empty()) {
            all.push_back(&series);
        }
    }
    // One line above each plot and one below.
    const float lines = 2.0f * ImGui::GetTextLineHeightWithSpacing() + ImGui::GetStyle().ItemSpacing.y;
    const float high = ImGui::GetContentRegionAvail().y / static_cast<float>(all.size()) - lines;
    for (const Series* const shown : all) {
        const Series& series = *shown;
        put(fmt::format("{} [{}]", translate(series.field->short_label), series.field->unit));
        at_right(series.samples.empty() ? "-" : fmt::format("{:.1f}", series.samples.back().value),
                 hud::white);
        const float wide = ImGui::GetContentRegionAvail().x;
        draw_series(series, model.history().newest_s(),
                    ImVec2(wide, std::max(2.0f * ImGui::GetFontSize(), high)));
        put(translate_format("{:g} to {:.3g}", series.low(), series.high()), hud::grey);
        at_right(translate_format("last {:.0f} s", History::span_s), hud::grey);
    }
}

void PanelRenderer::draw_health(const Model& model) {
    for (const HealthLine& line : model.health()) {
        put(line.label, hud::grey);
        const float room = ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(line.label.c_str()).x;
        if (ImGui::CalcTextSize(line.value.c_str()).x > room - ImGui::GetFontSize()) {
            wrapped(line.value, hud::colour_of(line.level));
        } else {
            at_right(line.value, hud::colour_of(line.level));
        }
    }
}

}  // namespace eti::panel
