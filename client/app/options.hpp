// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "client/app/selection.hpp"
#include "client/hmd/room.hpp"
#include "client/render/quality.hpp"
#include "common/bus/bus.hpp"

namespace eti::client {

struct Options {
    bus::Options bus{.name = "eti-client", .one_of_many = true};
    bool observe = false;     ///< watch only: publishes nothing
    bool instructor = false;  ///< gives commands, but the eye is not the trainee's
    const Selection* selection = &default_selection();
    bool panel = false;           ///< the instructor's, shown from the start
    bool headset = false;         ///< `--view hmd`: in a headset, not in a window
    bool left_eye_leads = false;  ///< of a headset's eyes: the one that the line of sight begins at
    Vec3f gum_in_room = hmd::Room().gum;
    render::Vantage vantage;          ///< from where views are drawn, until somebody moves it
    std::filesystem::path offscreen;  ///< folder for pictures; empty: a window
    std::filesystem::path video;      ///< empty: none
    double every_s = 5.0;             ///< of simulation time between pictures; 0: only best and last
    double frames_per_second = 15.0;  ///< of simulation time, in the video
    std::uint64_t frames = 0;         ///< end after this many; 0: with the session
    std::optional<double> wait_s;     ///< without a server, before giving up
    /// Pictures have nobody who would end them; a window waits for as long as it is open.
    static constexpr double pictures_wait_s = 20.0;
    int width = 960;
    int height = 540;
    const render::Quality* quality = nullptr;  ///< none: what the driver can afford
    bool hands = false;                        ///< mouse and keys hold blade and tube
    bool tutorial = false;                     ///< lead through a first intubation
    std::filesystem::path play;                ///< list of what they do; empty: a person does
    std::optional<bool> sound;                 ///< none: where there is a device to play on
    float volume = 0.5f;
    bool json = false;

    /// Of one trainee the session hears where the eye is.
    [[nodiscard]] bool is_trainee() const { return !observe && !instructor; }
};

/// Reads the command line; an exit status when the program is to end at once (help, version, mistake).
[[nodiscard]] std::optional<int> parse(int argc, char** argv, Options& options);

}  // namespace eti::client
