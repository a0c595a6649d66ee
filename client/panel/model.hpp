// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/panel/health.hpp"
#include "client/panel/history.hpp"
#include "client/view/scene_view.hpp"
#include "common/bus/command_sender.hpp"
#include "common/process/rate_limiter.hpp"
#include "common/scenario/preset.hpp"

namespace eti::panel {

enum class Group : std::uint8_t {
    published,  ///< set by the panel of Xiao et al. 2020
    other,
    aids,  ///< switches of the learner's aids
};

/// A runtime parameter as the panel shows it; values in displayed units.
struct ParameterRow {
    std::string name;  ///< command name
    std::string label, unit, help;
    float per_unit = 1.0f;  ///< SI value of one displayed unit
    float low = 0.0f, high = 1.0f;
    float start = 0.0f;  ///< value at the start of the session
    float rate = 0.0f;   ///< per second, at which the scene follows; 0: at once
    bool relative = false, on_off = false;
    Group group = Group::other;
    std::optional<float> now;     ///< as last published by the server
    std::optional<float> wanted;  ///< requested here, neither reached nor refused so far
    std::string refusal;          ///< why the server refused the last request
};

/// Formats a value of this row with its unit.
[[nodiscard]] std::string format_value(const ParameterRow& row, float typed);

/// Whether every word of `search` occurs in the row's label, name or help, ignoring case.
[[nodiscard]] bool matches(const ParameterRow& row, std::string_view search);

enum class Page : std::uint8_t { patient, aids, session, plots, health };
inline constexpr Page pages[] = {Page::patient, Page::aids, Page::session, Page::plots, Page::health};
[[nodiscard]] std::string_view title(Page page);

/// State and actions of the instructor's panel, without its renderer. Built from the server's description,
/// so that a parameter unknown to this program also becomes a slider. Single-threaded.
class Model {
  public:
    using Time = std::chrono::steady_clock::time_point;
    /// Sends a command with its value [SI]; false: no server accepts commands.
    using Send = std::function<bool(std::string_view name, float value)>;

    /// `send`: empty for an observer, who sends nothing. `presets`: presets to offer.
    explicit Model(Send send, Presets presets = {});

    /// Takes in the server's current state.
    void follow(const view::SceneView& scene, const Connection& connection, Time now);
    /// Records the server's refusals since the last call.
    void note_refusals(std::span<const bus::Refusal> refusals);
    /// Sends queued commands: at most ten per second and parameter, and in total at most as many as a
    /// server accepts.
    void update(Time now);

    /// Does nothing if commands() is false.
    void request(std::size_t row, float typed);
    void request(const Preset& preset);
    /// Returns all parameters of a group to their values at the start of the session.
    void request_initial_values(Group group);
    /// A command without a value: start, stop, reset, next.
    void request(std::string_view command);

    [[nodiscard]] bool commands() const { return send_ != nullptr; }
    /// In display order: by group, the paper's in its order.
    [[nodiscard]] std::span<const ParameterRow> rows() const { return rows_; }
    [[nodiscard]] const Presets& presets() const { return presets_; }
    /// The last preset requested, or null.
    [[nodiscard]] const Preset* chosen() const { return chosen_; }
    /// Why a command without a value was refused, or why nothing could be sent; else empty.
    [[nodiscard]] const std::string& refusal() const { return refusal_; }

    /// The server's status is more than a second old: the values shown are out of date.
    [[nodiscard]] bool stale(Time now) const;
    /// Time since the last status [s].
    [[nodiscard]] double silent_s(Time now) const;

    struct Session {
        std::string scenario, description, phase;
        double time_s = 0.0;  ///< simulation time
        unsigned attempt = 0;
        bool attempt_running = false;
    };
    [[nodiscard]] const Session& session() const { return session_; }
    [[nodiscard]] const History& history() const { return history_; }
    [[nodiscard]] std::span<const HealthLine> health() const { return health_; }

    Page page = Page::patient;
    std::string search;  ///< on the patient page

  private:
    struct PendingValue {
        bool unsent = false;
        std::optional<Time> sent;
        std::uint64_t until_ns = 0;  ///< simulation time at which the scene has followed, or the wait times
                                     ///< out
    };

    void describe(const msg::SessionDescription& description);
    void follow_values(const msg::LiveMetrics& metrics, std::uint64_t time_ns);
    [[nodiscard]] double seconds_to_follow(const ParameterRow& row) const;

    Send send_;
    Presets presets_;
    const Preset* chosen_ = nullptr;
    std::vector<ParameterRow> rows_;
    std::vector<PendingValue> pending_;         // by row
    std::vector<std::size_t> message_index_;    // by row: index in the server's messages
    std::vector<std::string> queued_commands_;  // commands without a value
    std::string refusal_;
    RateLimiter rate_limiter_;
    std::uint64_t described_ns_ = 0;  // server time of the description of rows_
    std::uint64_t time_ns_ = 0;
    std::uint64_t status_ns_ = 0;          // server time of the newest status
    std::optional<Time> status_received_;  // when it was received
    Session session_;
    History history_;
    std::vector<HealthLine> health_;
};

}  // namespace eti::panel
