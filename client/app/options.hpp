// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "client/app/window/selection.hpp"
#include "client/hmd/room.hpp"
#include "client/render/quality.hpp"
#include "common/bus/bus.hpp"

namespace eti::client {

struct Options {
    bus::Options bus{.name = "eti-client", .shared_multicast = true};
    bool observe = false;     ///< watch only: publishes nothing
    bool instructor = false;  ///< sends commands, but is not the trainee's eye
    const Selection* selection = &default_selection();
    bool panel = false;              ///< the instructor's panel, shown from the start
    bool headset = false;            ///< `--view hmd`: in a headset instead of a window
    bool left_eye_dominant = false;  ///< headset eye at which the line of sight starts
    Vec3f gum_in_room = hmd::Room().gum;
    render::Vantage vantage;          ///< initial vantage of the views
    std::filesystem::path offscreen;  ///< folder for pictures; empty: use a window
    std::filesystem::path video;      ///< empty: none
    double picture_interval_s = 5.0;  ///< of simulation time between pictures; 0: only best and last
    double frames_per_second = 15.0;  ///< frames per second of simulation time, in the video
    std::uint64_t frames = 0;         ///< exit after this many; 0: when the session ends
    std::optional<double> wait_s;     ///< [s] time to wait for a server
    /// Default wait without a window, which no user would close; a window waits until it is closed.
    static constexpr double offscreen_wait_s = 20.0;
    int width = 960;
    int height = 540;
    float text_scale = 1.0f;                   ///< of overlay and panel
    const render::Quality* quality = nullptr;  ///< null: the best the driver can afford
    bool hands = false;                        ///< mouse and keys control blade and tube
    bool tutorial = false;                     ///< guide through a first intubation
    std::filesystem::path play;                ///< playback list for the hands; empty: the user controls
                                               ///< them
    std::optional<bool> sound;                 ///< nullopt: on if there is an audio device
    float volume = 0.5f;
    bool json = false;

    [[nodiscard]] const render::Quality& drawing_quality() const {
        return quality != nullptr ? *quality : render::affordable_quality();
    }
    /// The server expects the eye pose of exactly one trainee.
    [[nodiscard]] bool is_trainee() const { return !observe && !instructor; }
    /// A person watches: in a window or a headset.
    [[nodiscard]] bool interactive() const { return offscreen.empty(); }
    [[nodiscard]] bool sends_commands() const { return !observe && interactive(); }
    /// Deformation at 90 Hz. 30 Hz suffice for an observer, and for a video of at most that rate.
    [[nodiscard]] bool full_rate() const { return interactive() ? !observe : frames_per_second > 30.0; }
};

/// Parses the command line; returns an exit status if the program should end at once (help, version,
/// error).
[[nodiscard]] std::optional<int> parse(int argc, char** argv, Options& options);

}  // namespace eti::client
