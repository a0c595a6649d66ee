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
#include "common/process/allowance.hpp"
#include "common/scenario/preset.hpp"

namespace eti::panel {

enum class Group : std::uint8_t {
    paper,  ///< what the panel of Xiao et al. 2020 changed
    more,
    aids,  ///< switches of what helps a learner
};

/// A value that lives, as the panel shows it; all as typed.
struct Row {
    std::string name;  ///< of its command
    std::string label, unit, help;
    float per_unit = 1.0f;  ///< SI value of one typed unit
    float low = 0.0f, high = 1.0f;
    float start = 0.0f;  ///< as the session began
    float rate = 0.0f;   ///< per second, by which the scene follows; 0: at once
    bool relative = false, on_off = false;
    Group group = Group::more;
    std::optional<float> now;     ///< as the server last said
    std::optional<float> wanted;  ///< asked for here, and neither reached nor refused so far
    std::string refusal;          ///< why the server refused what was asked for last
};

/// A number of this row as people read it, with its unit.
[[nodiscard]] std::string shown(const Row& row, float typed);

/// Whether every word of `search` stands in the row's label, name or help, whatever its case.
[[nodiscard]] bool matches(const Row& row, std::string_view search);

enum class Page : std::uint8_t { patient, aids, session, plots, health };
inline constexpr Page pages[] = {Page::patient, Page::aids, Page::session, Page::plots, Page::health};
[[nodiscard]] std::string_view title(Page page);

/// What the instructor's panel shows and does, without what draws it. It walks the values that the server
/// describes: one that this program has never heard of is a slider, too. One thread uses it.
class Model {
  public:
    using Time = std::chrono::steady_clock::time_point;
    /// Sends a command with its value [SI]; false: no server takes commands.
    using Send = std::function<bool(std::string_view name, float value)>;

    /// `send`: empty for one who only watches, and sends nothing. `presets`: to choose from.
    explicit Model(Send send, Presets presets = {});

    /// Takes in what the server says now.
    void follow(const view::SceneView& scene, const Connection& connection, Time now);
    /// What the server refused since the last call.
    void hear(std::span<const bus::Refusal> refusals);
    /// Sends what waits: of one value ten commands a second at most, of all as many as a server takes.
    void tend(Time now);

    /// Nothing happens where commands() is false.
    void ask(std::size_t row, float typed);
    void ask(const Preset& preset);
    /// All of a group back to how the session began.
    void ask_start(Group group);
    /// A command without a value: start, stop, reset, next.
    void ask(std::string_view command);

    [[nodiscard]] bool commands() const { return send_ != nullptr; }
    /// In the order of display: by group, those of the paper in its order.
    [[nodiscard]] std::span<const Row> rows() const { return rows_; }
    [[nodiscard]] const Presets& presets() const { return presets_; }
    /// The one asked for last, or null.
    [[nodiscard]] const Preset* chosen() const { return chosen_; }
    /// Why a command without a value was refused, or why nothing could be sent; else empty.
    [[nodiscard]] const std::string& refusal() const { return refusal_; }

    /// The server's status has not come for a second: what is shown is old.
    [[nodiscard]] bool stale(Time now) const;
    /// Since it came last [s].
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
    std::string search;  ///< on the patient's page

  private:
    struct Wish {
        bool unsent = false;
        std::optional<Time> sent;
        std::uint64_t until_ns = 0;  ///< simulation time by which the scene has followed, or never will
    };

    void describe(const msg::SessionDescription& description);
    void follow_values(const msg::LiveMetrics& metrics, std::uint64_t time_ns);
    [[nodiscard]] double seconds_to_follow(const Row& row) const;

    Send send_;
    Presets presets_;
    const Preset* chosen_ = nullptr;
    std::vector<Row> rows_;
    std::vector<Wish> wishes_;          // of each row
    std::vector<std::size_t> on_wire_;  // of each row, its place in the server's messages
    std::vector<std::string> waiting_;  // commands without a value
    std::string refusal_;
    Allowance allowed_;
    std::uint64_t described_ns_ = 0;  // when the server wrote the description that rows_ are of
    std::uint64_t time_ns_ = 0;
    std::uint64_t status_ns_ = 0;  // when the server wrote the newest status
    std::optional<Time> heard_;    // and when that came
    Session session_;
    History history_;
    std::vector<HealthLine> health_;
};

}  // namespace eti::panel
