// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/view/scene_view.hpp"

namespace eti::hud {

/// State of the connection to the server.
enum class ServerLink { waiting, running, finished, lost };

/// Traffic-light level.
enum class Level { good, warning, bad, neutral };

/// Level of a live measure by the limits of its row; `value`: as shown.
[[nodiscard]] Level level_of(float LiveMeasures::*measure, double value);

/// Outcome of an attempt or the run, as text.
struct Verdict {
    std::string title;             ///< "attempt 2: success"
    Level level = Level::neutral;  ///< neutral if the outcome was not measured
    std::string reason;
    /// Label and value with its unit.
    std::vector<std::pair<std::string, std::string>> numbers;
};

/// The values an instructor watches, shown over the picture.
struct Readout {
    ServerLink link = ServerLink::waiting;
    double time_s = 0.0;   ///< simulation time
    unsigned attempt = 0;  ///< 0 before the first
    bool attempt_running = false;
    bool airway_measured = true;  ///< else gum force, view and tube position are not meaningful
    LiveMeasures measures;
    float blade_depth_cm = 0.0f;  ///< past the upper gum; 0 while the tip is outside
    /// Vital signs of the newborn, if they are simulated.
    struct VitalSigns {
        double oxygen_saturation_percent = 0.0;
        double heart_rate_per_min = 0.0;
    };
    std::optional<VitalSigns> vital_signs;
    /// Clock of the attempt, if the session requests it.
    struct Clock {
        double time_s = 0.0, limit_s = 30.0;
        [[nodiscard]] Level level() const;
    };
    std::optional<Clock> clock;
    /// Tube depth at the lip, if the session requests it and the tube is in the mouth.
    struct TubeDepth {
        double at_lip_cm = 0.0, rule_cm = 0.0;
        [[nodiscard]] Level level() const;
    };
    std::optional<TubeDepth> tube_depth;
    std::vector<std::string> alarms;    ///< current harms, if the session requests warnings
    float server_load = 0.0f;           ///< step time divided by step budget
    float behind_s = 0.0f;              ///< wall clock minus simulation time
    std::string scenario;               ///< its name
    std::string description;            ///< of the scenario, in the first seconds and while waiting; its
                                        ///< debriefing once the session has finished; else empty
    std::string message;                ///< the server's newest message
    std::string warning;                ///< a second server, or a device that went silent; else empty
    std::string note;                   ///< last note of an instructor or observer, shown for some seconds
    std::string notice;                 ///< notice of this client, e.g. a refused command
    std::vector<std::string> guidance;  ///< tutorial text: a title, then sentences
    std::vector<std::pair<std::string, std::string>> keys;  ///< help, if requested
    std::optional<Verdict> verdict;  ///< for some seconds after an attempt, and once the session has
                                     ///< finished
};

/// `contested`: a second server publishes the same session.
[[nodiscard]] Readout make_readout(const view::SceneView& scene, bool server_lost, bool contested = false);

/// Straight distance [m] from the gum's midpoint to the blade's tip; 0 until the tip has passed the gum on
/// its way to the glottis.
[[nodiscard]] float blade_depth(const Landmarks& points, const Vec3f& tip);

}  // namespace eti::hud
