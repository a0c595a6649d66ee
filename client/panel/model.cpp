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

#include "client/text/catalogue.hpp"
#include "client/text/server_sentences.hpp"

namespace eti::panel {
namespace {

using namespace std::chrono_literals;

// Rate that a server accepts from one sender; excess commands wait here, or are replaced.
constexpr double per_second = 20.0;
// Per parameter: fast enough for a moving slider, half of what the server accepts.
constexpr auto between_commands = 100ms;
constexpr auto stale_after = 1s;    // ten status periods
constexpr double patience_s = 2.0;  // in addition to the time the scene takes to follow
constexpr float reached = 1e-4f;    // of a row's range: float rounding

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
            return text::translatable("waiting");
        case msg::PHASE_RUNNING:
            return text::translatable("running");
        case msg::PHASE_FROZEN:
            return text::translatable("paused");
        case msg::PHASE_FINISHED:
            return text::translatable("finished");
    }
    return text::translatable("unknown");
}

ParameterRow row_of(const msg::LiveKey& key) {
    ParameterRow row;
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
                : place_in_paper(row.name) < of_paper.size() ? Group::published
                                                             : Group::other;
    return row;
}

bool usable(const ParameterRow& row) {
    return !row.name.empty() && std::isfinite(row.per_unit) && row.per_unit != 0.0f &&
           std::isfinite(row.start) && std::isfinite(row.low) && std::isfinite(row.high) &&
           row.low < row.high;
}

}  // namespace

std::string format_value(const ParameterRow& row, float typed) {
    if (row.on_off) {
        return std::string(typed > 0.5f ? text::translate("on") : text::translate("off"));
    }
    const float range = row.high - row.low;
    const int digits = range >= 100.0f ? 0 : range >= 10.0f ? 1 : 2;
    return fmt::format("{:.{}f}{}{}", typed, digits, row.unit.empty() ? "" : " ", row.unit);
}

bool matches(const ParameterRow& row, std::string_view search) {
    const std::string words = lower(search),
                      text = lower(fmt::format("{} {} {} {} {}", row.label, row.name, row.help,
                                               text::translate(row.label), text::translate(row.help)));
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
            return text::translatable("Patient");
        case Page::aids:
            return text::translatable("Aids");
        case Page::session:
            return text::translatable("Session");
        case Page::plots:
            return text::translatable("Plots");
        case Page::health:
            break;
    }
    return text::translatable("Health");
}

Model::Model(Send send, Presets presets)
    : send_(std::move(send)), presets_(std::move(presets)), rate_limiter_(per_second) {}

void Model::describe(const msg::SessionDescription& description) {
    rows_.clear();
    message_index_.clear();
    std::vector<ParameterRow> described;
    for (const msg::LiveKey& key : description.live()) {
        described.push_back(row_of(key));
    }
    std::vector<std::size_t> order(described.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) {
        const ParameterRow& row = described[i];
        return std::pair(row.group, row.group == Group::published ? place_in_paper(row.name) : 0);
    });
    for (const std::size_t i : order) {
        if (usable(described[i])) {
            rows_.push_back(std::move(described[i]));
            message_index_.push_back(i);
        }
    }
    pending_.assign(rows_.size(), {});
    queued_commands_.clear();
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
        if (!status_received_ || status->header().send_time_ns() != status_ns_) {
            status_ns_ = status->header().send_time_ns();
            status_received_ = now;
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
        ParameterRow& row = rows_[i];
        const std::size_t place = message_index_[i];
        const float now = place < metrics.live().size() ? metrics.live()[place] / row.per_unit
                                                        : std::numeric_limits<float>::quiet_NaN();
        row.now = std::isfinite(now) ? std::optional(now) : std::nullopt;
        if (row.wanted && !pending_[i].unsent &&
            ((row.now && std::abs(*row.now - *row.wanted) <= reached * (row.high - row.low)) ||
             time_ns > pending_[i].until_ns)) {
            row.wanted.reset();
        }
    }
}

double Model::seconds_to_follow(const ParameterRow& row) const {
    if (row.rate <= 0.0f || !row.now || !row.wanted) {
        return 0.0;
    }
    const double from = static_cast<double>(*row.now), to = static_cast<double>(*row.wanted);
    const double way =
        row.relative && from > 0.0 && to > 0.0 ? std::abs(std::log(to / from)) : std::abs(to - from);
    return way / static_cast<double>(row.rate);
}

void Model::note_refusals(std::span<const bus::Refusal> refusals) {
    for (const bus::Refusal& refusal : refusals) {
        const auto row = std::ranges::find(rows_, refusal.name, &ParameterRow::name);
        if (row == rows_.end()) {
            refusal_ = text::translate_sentence(refusal.reason);
            continue;
        }
        row->refusal = text::translate_sentence(refusal.reason);
        // A later request may still be accepted.
        if (!pending_[static_cast<std::size_t>(row - rows_.begin())].unsent) {
            row->wanted.reset();
        }
    }
}

void Model::request(std::size_t row, float typed) {
    if (!commands() || !std::isfinite(typed)) {
        return;
    }
    ParameterRow& asked = rows_.at(row);
    asked.wanted = asked.on_off ? (typed > 0.5f ? 1.0f : 0.0f) : std::clamp(typed, asked.low, asked.high);
    asked.refusal.clear();
    pending_[row].unsent = true;
}

void Model::request(const Preset& preset) {
    if (!commands()) {
        return;
    }
    for (const RuntimeParameterSetting& value : preset.values) {
        if (const auto row = std::ranges::find(rows_, value.field->name, &ParameterRow::name);
            row != rows_.end()) {
            request(static_cast<std::size_t>(row - rows_.begin()), value.value / row->per_unit);
        }
    }
    chosen_ = &preset;
}

void Model::request_initial_values(Group group) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (rows_[i].group == group) {
            request(i, rows_[i].start);
        }
    }
}

void Model::request(std::string_view command) {
    if (commands()) {
        refusal_.clear();
        queued_commands_.emplace_back(command);
    }
}

void Model::update(Time now) {
    bool served = true;
    const auto sent = [&](std::string_view name, float value) {
        served = served && send_(name, value);
        return served;
    };
    for (const std::string& command : std::exchange(queued_commands_, {})) {
        (void)sent(command, 1.0f);
    }
    for (std::size_t i = 0; i < rows_.size() && served; ++i) {
        PendingValue& pending = pending_[i];
        ParameterRow& row = rows_[i];
        if (!pending.unsent || (pending.sent && now - *pending.sent < between_commands) ||
            !rate_limiter_.try_acquire(now)) {
            continue;
        }
        if (sent(row.name, *row.wanted * row.per_unit)) {
            pending.unsent = false;
            pending.sent = now;
            pending.until_ns =
                time_ns_ + static_cast<std::uint64_t>(1e9 * (seconds_to_follow(row) + patience_s));
        }
    }
    if (!served) {
        // No server: requests are dropped, not sent to a later one.
        refusal_ = text::translate("no server accepts commands");
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            if (std::exchange(pending_[i].unsent, false)) {
                rows_[i].wanted.reset();
            }
        }
    }
}

double Model::silent_s(Time now) const {
    return status_received_ ? std::chrono::duration<double>(now - *status_received_).count() : 0.0;
}

bool Model::stale(Time now) const {
    return !status_received_ || now - *status_received_ > stale_after;
}

}  // namespace eti::panel
