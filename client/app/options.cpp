// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/options.hpp"

#include <charconv>
#include <cmath>
#include <iostream>
#include <vector>

#include <fmt/format.h>

#include "client/app/controls.hpp"
#include "client/app/tutorial.hpp"
#include "client/app/window/hand_controls.hpp"
#include "client/app/window/hand_keys.hpp"
#include "client/hud/hud.hpp"
#include "client/hud/letters.hpp"
#include "client/text/catalogue.hpp"
#include "common/bus/command_line.hpp"
#include "common/math/units.hpp"
#include "common/process/command_line.hpp"

namespace eti::client {
namespace {

constexpr const char* headset_name = "hmd";
constexpr int smallest_side = 64;
constexpr int largest_side = 7680;

// "WxH" with even sides: video codecs store chroma at half resolution.
bool read_size(const std::string& text, int& width, int& height) {
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, width);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x') {
        return false;
    }
    const auto second = std::from_chars(first.ptr + 1, end, height);
    const auto fits = [](int side) { return side >= smallest_side && side <= largest_side && side % 2 == 0; };
    return second.ec == std::errc() && second.ptr == end && fits(width) && fits(height);
}

// Three numbers "A,B,C", each within plus or minus its limit.
std::optional<Vec3f> read_three(const std::string& text, const Vec3f& limits) {
    Vec3f numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    for (int i = 0; i < 3; ++i) {
        if (i > 0 && (at == end || *at++ != ',')) {
            return std::nullopt;
        }
        const auto [past, error] = std::from_chars(at, end, numbers[i]);
        // Written so that NaN is rejected.
        if (error != std::errc() || !(std::abs(numbers[i]) <= limits[i])) {
            return std::nullopt;
        }
        at = past;
    }
    return at == end ? std::optional(numbers) : std::nullopt;
}

// Input order: right, up, ahead; the world's z points back.
std::optional<Vec3f> read_place(const std::string& text) {
    const auto mm = read_three(text, Vec3f::Constant(1e3f * hmd::Room::max_offset));
    return mm ? std::optional(Vec3f(1e-3f * mm->x(), 1e-3f * mm->y(), -1e-3f * mm->z())) : std::nullopt;
}

std::optional<view::TraineeEye> read_eye(const std::string& text) {
    const auto mm = read_three(text, Vec3f::Constant(1e3f * view::TraineeEye::max_offset));
    return mm ? std::optional(view::TraineeEye(1e-3f * *mm)) : std::nullopt;
}

std::optional<render::Section> read_section(const std::string& text) {
    const auto typed = read_three(text, {1e3f * render::Section::max_offset, 180.0f, 90.0f});
    return typed
               ? std::optional(render::Section(1e-3f * typed->x(), degree * typed->y(), degree * typed->z()))
               : std::nullopt;
}

// Adds an option whose text `read` understands; `expected`: its error continues with it.
template <class Value>
void add_text(CommandLine& app, const std::string& name, std::string& text, const std::string& help,
              std::optional<Value> (*read)(const std::string&), const std::string& shape,
              const std::string& expected) {
    app.add_option(name, text, help)
        .capture_default_str()
        .check(
            [=](const std::string& typed) {
                return read(typed) ? std::string() : fmt::format("'{}' is no {}", typed, expected);
            },
            shape);
}

}  // namespace

std::optional<int> parse(int argc, char** argv, Options& options) {
    CommandLine app("Shows a running session to its trainee, an --instructor, or a spectator (--observe).",
                    "eti-client");
    std::vector<std::string> names;
    std::string of_views;
    for (const Selection& one : selections()) {
        names.emplace_back(one.name);
        of_views += fmt::format("{}{}: {}", of_views.empty() ? "" : "; ", one.name, one.help);
    }
    names.emplace_back(headset_name);
    of_views += fmt::format("; {}: in a headset", headset_name);
    std::vector<std::string> quality_names{"auto"};
    std::string of_qualities = "auto: high with a graphics card, low without";
    for (const render::Quality& one : render::qualities()) {
        quality_names.emplace_back(one.name);
        of_qualities += fmt::format("; {}: {}", one.name, one.help);
    }
    std::string language = "auto", of_languages;
    std::vector<std::string> language_codes{"auto"};
    for (const text::Language& one : text::languages()) {
        language_codes.emplace_back(one.code);
        of_languages += fmt::format("; {}: {}", one.code, one.name);
    }
    std::string quality = "auto", tutorial = "auto", sound = "auto";
    std::string view(options.selection->name);
    std::string size = "960x540";
    std::string eye_offset = "0,0,0", section = "0,0,0", dominant_eye = "right";
    const Vec3f gum = 1e3f * options.gum_in_room;
    std::string gum_at = fmt::format("{:.0f},{:.0f},{:.0f}", gum.x(), gum.y(), -gum.z());
    bool no_video = false;
    std::string keys;
    const auto list = [&](const char* heading, int width, const auto& rows) {
        keys += heading;
        for (const auto& [input, help] : rows) {
            keys += fmt::format("\n  {:<{}} {}", input, width, help);
        }
    };
    list("Keys in the window:", 6, keys_help(true, true));
    list("\nWith --hands:", 11, hand_controls_help());
    list("\nHand controllers, with --view hmd:", 11, hands_help());
    app.footer(keys + "\nWith --observe no commands are sent; remarks (w, z) and marks need --instructor.");
    const auto view_option = app.add_option("--view", view, of_views).capture_default_str().one_of(names);
    const auto observe = app.add_flag("--observe", options.observe,
                                      "Watch only: publish nothing and send no commands; without it the "
                                      "trainee's line of sight is published");
    app.add_flag("--instructor", options.instructor,
                 "Watch and send commands, with the panel; four views unless --view is given; the line of "
                 "sight remains the trainee's")
        .excludes(observe);
    app.add_flag("--panel", options.panel, "Show the instructor's panel from the start (key p or F1)");
    add_text(app, "--eye-offset-mm", eye_offset,
             "Offset of the trainee's eye from the position with the best view of the glottis: towards the "
             "patient's left, back and head",
             read_eye, "X,Y,Z",
             fmt::format("place of an eye; expected X,Y,Z in mm, each from -{0:.0f} to {0:.0f}, e.g. 10,0,-5",
                         1e3f * view::TraineeEye::max_offset));
    add_text(
        app, "--patient-at-mm", gum_at,
        "In a headset: position of the upper gum to the right of, above and ahead of the eyes at recentring",
        read_place, "RIGHT,UP,AHEAD",
        fmt::format("place; expected RIGHT,UP,AHEAD in mm, each from -{0:.0f} to {0:.0f}, e.g. "
                    "0,-300,250",
                    1e3f * hmd::Room::max_offset));
    app.add_option("--dominant-eye", dominant_eye,
                   "In a headset: the eye from which the line of sight starts and the view is measured")
        .capture_default_str()
        .one_of({"right", "left"});
    add_text(app, "--section-plane", section,
             "Section plane: offset from the midline towards the patient's left [mm]; rotation about the "
             "patient's back-to-front axis and tilt about its long axis [deg]",
             read_section, "OFFSET,TURN,TILT",
             fmt::format("plane; expected OFFSET,TURN,TILT: mm from -{0:.0f} to {0:.0f}, degrees from -180 "
                         "to 180 and from -90 to 90, e.g. 5,0,0 or 0,90,0",
                         1e3f * render::Section::max_offset));
    app.add_number("--fogging", options.vantage.fogging,
                   "Start with a fogged lens; the blade's lamp warms and clears it", {0.0f, 1.0f})
        .capture_default_str();
    app.add_number("--loupe", options.vantage.loupe.magnification,
                   "Start with a loupe of this magnification before the trainee's eye; 1: without (key 8)",
                   {1.0f, render::Loupe::max_magnification})
        .capture_default_str();
    app.add_flag("!--no-hands", options.vantage.hands, "Show the tools without the hands that hold them");
    const auto offscreen = app.add_option("--offscreen", options.offscreen,
                                          "Render without a display; write pictures to this folder");
    const auto video =
        app.add_option("--video", options.video,
                       "Video file (.mp4), paced on simulation time [default, for an offscreen "
                       "trainee: session.mp4 in the folder]")
            .needs(offscreen);
    app.add_flag("--no-video", no_video, "Do not write a video").excludes(video);
    app.add_number("--fps", options.frames_per_second, "Frame rate of the video",
                   {1.0, 90.0, "frames per second of simulation time"})
        .capture_default_str();
    app.add_number("--every", options.picture_interval_s,
                   "Simulation time between pictures; 0: only the best view and the final picture",
                   {0.0, 3600.0, "s"})
        .capture_default_str();
    app.add_number("--frames", options.frames,
                   "Stop after this many frames that show a patient; 0: at the end of the session", {0})
        .capture_default_str();
    app.add_number("--wait", options.wait_s,
                   fmt::format("Give up if no server is found for this time; by default offscreen rendering "
                               "waits for {:.0f} s, a window until it is closed",
                               Options::offscreen_wait_s),
                   {0.0, 3600.0, "s"});
    app.add_option("--size", size, "Size in pixels, WIDTHxHEIGHT, both even")
        .capture_default_str()
        .check(
            [](const std::string& text) {
                int width = 0, height = 0;
                return read_size(text, width, height) ? std::string()
                                                      : "'" + text +
                                                            "' is not a size; expected WIDTHxHEIGHT, even "
                                                            "numbers from 64 to 7680, e.g. 1280x720";
            },
            "WxH");
    app.add_option("--quality", quality, of_qualities).capture_default_str().one_of(quality_names);
    app.add_number("--text-scale", options.text_scale,
                   "Size of the texts; 1: letters a fortieth of the picture's shorter side high",
                   {hud::Hud::min_text_scale, hud::Hud::max_text_scale})
        .capture_default_str();
    app.add_option("--language", language,
                   fmt::format("Language of texts; auto: as the environment says (LANGUAGE, LC_ALL, "
                               "LC_MESSAGES, LANG){}",
                               of_languages))
        .capture_default_str()
        .one_of(language_codes);
    const auto hands = app.add_flag("--hands", options.hands,
                                    "Control blade and tube with mouse and keys, unless a device holds them");
    app.add_option("--tutorial", tutorial,
                   "With --hands, guide through a first intubation; auto: only the first time")
        .capture_default_str()
        .one_of({"auto", "on", "off"});
    app.add_option("--play", options.play, "Play mouse and key input from this file instead of a person's")
        .needs(hands)
        .existing_file();
    app.add_option("--sound", sound,
                   "Sounds: pulse oximeter, a click when the gum is pressed too hard, suction; auto: if the "
                   "machine has an audio device")
        .capture_default_str()
        .one_of({"auto", "on", "off"});
    app.add_number("--volume", options.volume, "Sound volume", {0.0f, 1.0f}).capture_default_str();
    bus::add_options(app, options.bus);
    app.add_flag("--json", options.json, "Print the results as one JSON object");
    if (const auto status = app.parse(argc, argv)) {
        return *status;
    }
    // Without the font there are no letters for most languages.
    text::set_language(hud::letters_file().empty() ? text::languages().front().code
                       : language == "auto"        ? text::language_of_environment()
                                                   : language);
    options.headset = view == headset_name;
    if (options.instructor && options.headset) {
        std::cerr << "--instructor excludes --view hmd, which follows the trainee's eyes; omit one of them\n";
        return 2;
    }
    if (options.headset && !options.offscreen.empty()) {
        std::cerr << "--view hmd excludes --offscreen, which renders without a headset; omit one of them\n";
        return 2;
    }
    if (options.hands && (options.headset || !options.is_trainee())) {
        std::cerr << fmt::format("--hands: {}; omit one of them\n",
                                 options.headset
                                     ? "with --view hmd the tools are held with devices"
                                     : "observers and instructors (--observe, --instructor) hold no tool");
        return 2;
    }
    // Playback needs no tutorial; learners use a window.
    options.tutorial =
        options.hands && (tutorial == "on" || (tutorial == "auto" && options.play.empty() &&
                                               options.offscreen.empty() && !tutorial_was_shown()));
    options.sound = sound == "auto" ? std::nullopt : std::optional(sound == "on");
    options.panel = options.panel || options.instructor;
    options.selection = options.headset                             ? &default_selection()
                        : options.instructor && view_option.empty() ? &instructor_selection()
                                                                    : selection_named(view);
    options.left_eye_dominant = dominant_eye == "left";
    options.gum_in_room = *read_place(gum_at);
    options.quality = render::quality_named(quality);
    (void)read_size(size, options.width, options.height);
    options.vantage.eye = *read_eye(eye_offset);
    options.vantage.section = *read_section(section);
    if (!no_video && options.video.empty() && !options.offscreen.empty() && options.is_trainee()) {
        options.video = options.offscreen / "session.mp4";
    }
    return std::nullopt;
}

}  // namespace eti::client
