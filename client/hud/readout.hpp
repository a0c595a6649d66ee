// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/view/scene_view.hpp"

namespace eti::hud {

/// Where the connection to the server stands.
enum class Link { waiting, running, finished, lost };

/// As traffic lights have it.
enum class Level { good, warning, bad, neutral };

/// Limits of the force [N] on the upper gum, and what it is between them. The mean maxima of Xiao et al.
/// 2020, Table 2, are 3.1-5.3 N.
inline constexpr float gum_force_warning_n = 2.0f, gum_force_bad_n = 4.0f;
[[nodiscard]] Level gum_force_level(float force);

/// Of the oxygen saturation [%] and of the heart rate [1/min], by the limits that count as severe in neonatal
/// airway registries (Herrick et al. 2020, Neonatology 117:65).
[[nodiscard]] Level saturation_level(double percent);
[[nodiscard]] Level heart_rate_level(double per_min);

/// How an attempt or the run ended, in words.
struct Verdict {
    std::string title;             ///< "attempt 2: success"
    Level level = Level::neutral;  ///< neutral where nobody measured the outcome
    std::string reason;
    /// Label and value with its unit.
    std::vector<std::pair<std::string, std::string>> numbers;
};

/// The numbers an instructor watches, as shown over the picture.
struct Readout {
    Link link = Link::waiting;
    double time_s = 0.0;   ///< simulation time
    unsigned attempt = 0;  ///< 0 before the first
    bool attempt_running = false;
    bool airway_measured = true;  ///< else force on the gum, view and the tube's place within say nothing
    float gum_force_n = 0.0f;
    float glottic_opening_percent = 0.0f;
    float blade_depth_cm = 0.0f;       ///< past the upper gum; 0 while the tip is outside
    float tube_past_cords_cm = -1.0f;  ///< negative before the cords
    float tube_force_n = 0.0f;         ///< on the hand that holds the tube
    /// Of the newborn, where they are simulated.
    struct VitalSigns {
        double oxygen_saturation_percent = 0.0;
        double heart_rate_per_min = 0.0;
    };
    std::optional<VitalSigns> vital_signs;
    /// Of the attempt, where the session asks for the clock.
    struct Clock {
        double time_s = 0.0, limit_s = 30.0;
        [[nodiscard]] Level level() const;
    };
    std::optional<Clock> clock;
    /// Of the tube at the lip, where the session asks for it and the tube is in the mouth.
    struct TubeDepth {
        double at_lip_cm = 0.0, rule_cm = 0.0;
        [[nodiscard]] Level level() const;
    };
    std::optional<TubeDepth> tube_depth;
    std::vector<std::string> alarms;  ///< where the session asks for warnings: what harms now
    float server_load = 0.0f;         ///< step time over step budget
    float behind_s = 0.0f;            ///< wall clock minus simulation time
    std::string scenario;             ///< its name
    std::string description;          ///< of the scenario, in the first seconds and while waiting; else empty
    std::string message;              ///< the server's newest
    std::string warning;              ///< of a second server, or a device that fell silent; else empty
    std::string note;                 ///< what an instructor or observer wrote last, for some seconds
    std::string notice;               ///< what this client has to say, e.g. of a refused command
    std::vector<std::string> guidance;  ///< what to do next, where somebody is led: a title, then sentences
    std::vector<std::pair<std::string, std::string>> keys;  ///< help, where it was asked for
    std::optional<Verdict> verdict;  ///< for some seconds after an attempt, and once the session has finished
};

/// `contested`: a second server is there for the same session.
[[nodiscard]] Readout readout_of(const view::SceneView& scene, bool server_lost, bool contested = false);

/// Straight distance [m] from the gum's midpoint to the blade's tip, 0 while the tip has not passed
/// the gum on its way to the glottis.
[[nodiscard]] float blade_depth(const Landmarks& points, const Vec3f& tip);

}  // namespace eti::hud
