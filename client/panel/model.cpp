// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/panel/model.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

namespace eti::panel {
namespace {

using namespace std::chrono_literals;

// As many commands as a server takes of one sender; what is more waits there, or is replaced.
constexpr double per_second = 20.0;
// Of one value: as fast as one sees a slider move, half of what the server takes.
constexpr auto between_commands = 100ms;
constexpr auto stale_after = 1s;    // ten statuses
constexpr double patience_s = 2.0;  // beyond what the scene takes to follow
constexpr float reached = 1e-4f;    // of a row's range: what a float's rounding leaves

// In the order of the paper's panel.
constexpr std::array<std::string_view, 7> of_paper{"tongue_scale",       "tissue_stiffness", "head_elevation",
                                                   "jaw_opening",        "table_angle",      "secretion",
                                                   "tube_youngs_modulus"};

std::size_t place_in_paper(std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(of_paper, name) - of_paper.begin());
}

std::string lower(std::string_view text) {
    std::string out(text);
    std::ranges::transform(out, out.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return out;
}

std::string_view word_for(msg::SessionPhase phase) {
    switch (phase) {
        case msg::PHASE_WAITING:
            return "waiting";
        case msg::PHASE_RUNNING:
            return "running";
        case msg::PHASE_FROZEN:
            return "time stands still";
        case msg::PHASE_FINISHED:
            return "finished";
    }
    return "unknown";
}

Row row_of(const msg::LiveKey& key) {
    Row row;
    row.name = key.name().to_string();
    row.label = key.label().to_string();
    row.unit = key.unit().to_string();
    row.help = key.help().to_string();
    row.per_unit = key.per_unit();
    row.low = key.low();
    row.high = key.high();
    row.start = key.start() / key.per_unit();
    row.relative = key.relative();
    row.rate = key.relative() ? key.rate() : key.rate() / key.per_unit();
    row.on_off = key.on_off();
    row.group = key.on_off()                                 ? Group::aids
                : place_in_paper(row.name) < of_paper.size() ? Group::paper
                                                             : Group::more;
    return row;
}

bool usable(const Row& row) {
    return !row.name.empty() && std::isfinite(row.per_unit) && row.per_unit != 0.0f &&
           std::isfinite(row.start) && std::isfinite(row.low) && std::isfinite(row.high) &&
           row.low < row.high;
}

}  // namespace

std::string shown(const Row& row, float typed) {
    if (row.on_off) {
        return typed > 0.5f ? "on" : "off";
    }
    const float range = row.high - row.low;
    const int digits = range >= 100.0f ? 0 : range >= 10.0f ? 1 : 2;
    return fmt::format("{:.{}f}{}{}", typed, digits, row.unit.empty() ? "" : " ", row.unit);
}

bool matches(const Row& row, std::string_view search) {
    const std::string words = lower(search), text = lower(row.label + " " + row.name + " " + row.help);
    for (std::size_t at = 0; at < words.size();) {
        const std::size_t begin = words.find_first_not_of(' ', at);
        if (begin == std::string::npos) {
            break;
        }
        at = std::min(words.find(' ', begin), words.size());
        if (text.find(words.substr(begin, at - begin)) == std::string::npos) {
            return false;
        }
    }
    return true;
}

std::string_view title(Page page) {
    switch (page) {
        case Page::patient:
            return "Patient";
        case Page::aids:
            return "Aids";
        case Page::session:
            return "Session";
        case Page::plots:
            return "Plots";
        case Page::health:
            break;
    }
    return "Health";
}

Model::Model(Send send, Presets presets)
    : send_(std::move(send)), presets_(std::move(presets)), allowed_(per_second) {}

void Model::describe(const msg::SessionDescription& description) {
    rows_.clear();
    on_wire_.clear();
    std::vector<Row> described;
    for (const msg::LiveKey& key : description.live()) {
        described.push_back(row_of(key));
    }
    std::vector<std::size_t> order(described.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) {
        const Row& row = described[i];
        return std::pair(row.group, row.group == Group::paper ? place_in_paper(row.name) : 0);
    });
    for (const std::size_t i : order) {
        if (usable(described[i])) {
            rows_.push_back(std::move(described[i]));
            on_wire_.push_back(i);
        }
    }
    wishes_.assign(rows_.size(), {});
    waiting_.clear();
    refusal_.clear();
    chosen_ = nullptr;
    session_.scenario = description.scenario().to_string();
    session_.description = description.description().to_string();
}

void Model::follow(const view::SceneView& scene, const Connection& connection, Time now) {
    if (const auto& description = scene.description();
        description && (described_ns_ != description->header().send_time_ns() || rows_.empty())) {
        described_ns_ = description->header().send_time_ns();
        describe(*description);
    }
    time_ns_ = scene.simulation_time_ns();
    session_.time_s = 1e-9 * static_cast<double>(time_ns_);
    if (const auto& status = scene.status()) {
        if (!heard_ || status->header().send_time_ns() != status_ns_) {
            status_ns_ = status->header().send_time_ns();
            heard_ = now;
        }
        session_.phase = word_for(status->phase());
    }
    if (const auto& metrics = scene.metrics()) {
        session_.attempt = metrics->attempt();
        session_.attempt_running = metrics->attempt_running();
        follow_values(*metrics, time_ns_);
    }
    history_.follow(scene);
    health_ = health_of(scene, connection, silent_s(now));
}

void Model::follow_values(const msg::LiveMetrics& metrics, std::uint64_t time_ns) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        Row& row = rows_[i];
        const std::size_t place = on_wire_[i];
        const float now = place < metrics.live().size() ? metrics.live()[place] / row.per_unit
                                                        : std::numeric_limits<float>::quiet_NaN();
        row.now = std::isfinite(now) ? std::optional(now) : std::nullopt;
        if (row.wanted && !wishes_[i].unsent &&
            ((row.now && std::abs(*row.now - *row.wanted) <= reached * (row.high - row.low)) ||
             time_ns > wishes_[i].until_ns)) {
            row.wanted.reset();
        }
    }
}

double Model::seconds_to_follow(const Row& row) const {
    if (row.rate <= 0.0f || !row.now || !row.wanted) {
        return 0.0;
    }
    const double from = static_cast<double>(*row.now), to = static_cast<double>(*row.wanted);
    const double way =
        row.relative && from > 0.0 && to > 0.0 ? std::abs(std::log(to / from)) : std::abs(to - from);
    return way / static_cast<double>(row.rate);
}

void Model::hear(std::span<const bus::Refusal> refusals) {
    for (const bus::Refusal& refusal : refusals) {
        const auto row = std::ranges::find(rows_, refusal.name, &Row::name);
        if (row == rows_.end()) {
            refusal_ = refusal.reason;
            continue;
        }
        row->refusal = refusal.reason;
        // What was asked for since then may still be taken.
        if (!wishes_[static_cast<std::size_t>(row - rows_.begin())].unsent) {
            row->wanted.reset();
        }
    }
}

void Model::ask(std::size_t row, float typed) {
    if (!commands() || !std::isfinite(typed)) {
        return;
    }
    Row& asked = rows_.at(row);
    asked.wanted = asked.on_off ? (typed > 0.5f ? 1.0f : 0.0f) : std::clamp(typed, asked.low, asked.high);
    asked.refusal.clear();
    wishes_[row].unsent = true;
}

void Model::ask(const Preset& preset) {
    if (!commands()) {
        return;
    }
    for (const LiveSetting& value : preset.values) {
        if (const auto row = std::ranges::find(rows_, value.field->name, &Row::name); row != rows_.end()) {
            ask(static_cast<std::size_t>(row - rows_.begin()), value.value / row->per_unit);
        }
    }
    chosen_ = &preset;
}

void Model::ask_start(Group group) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (rows_[i].group == group) {
            ask(i, rows_[i].start);
        }
    }
}

void Model::ask(std::string_view command) {
    if (commands()) {
        refusal_.clear();
        waiting_.emplace_back(command);
    }
}

void Model::tend(Time now) {
    bool served = true;
    const auto sent = [&](std::string_view name, float value) {
        served = served && send_(name, value);
        return served;
    };
    for (const std::string& command : std::exchange(waiting_, {})) {
        (void)sent(command, 1.0f);
    }
    for (std::size_t i = 0; i < rows_.size() && served; ++i) {
        Wish& wish = wishes_[i];
        Row& row = rows_[i];
        if (!wish.unsent || (wish.sent && now - *wish.sent < between_commands) || !allowed_.take(now)) {
            continue;
        }
        if (sent(row.name, *row.wanted * row.per_unit)) {
            wish.unsent = false;
            wish.sent = now;
            wish.until_ns =
                time_ns_ + static_cast<std::uint64_t>(1e9 * (seconds_to_follow(row) + patience_s));
        }
    }
    if (!served) {
        // Nobody takes them: what was wished for is not sent to whoever comes.
        refusal_ = "no server takes commands";
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (std::exchange(wishes_[i].unsent, false)) {
                rows_[i].wanted.reset();
            }
        }
    }
}

double Model::silent_s(Time now) const {
    return heard_ ? std::chrono::duration<double>(now - *heard_).count() : 0.0;
}

bool Model::stale(Time now) const {
    return !heard_ || now - *heard_ > stale_after;
}

}  // namespace eti::panel
