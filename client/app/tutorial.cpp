// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/tutorial.hpp"

#include <array>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "client/text/catalogue.hpp"
#include "client/text/server_sentences.hpp"
#include "common/math/units.hpp"

namespace eti::client {
namespace {

using text::translatable;

// Chosen: the blade is behind the tongue, half of the glottis is visible, the tube's black band is near the
// cords.
constexpr float blade_in = 3.0f * centimetre, tube_in = 15.0f * millimetre, seen_percent = 50.0f;

bool shows_inside(const LessonState& sight) {
    return sight.view == "section" || sight.view == "all" || sight.scene.enhanced();
}

bool blade_is_in(const LessonState& sight) {
    const auto& scene = sight.scene;
    return scene.metrics() && scene.metrics()->attempt_running() && scene.keys() &&
           scene.laryngoscope_pose() &&
           hud::blade_depth(scene.landmarks(),
                            *scene.laryngoscope_pose() * scene.keys()->laryngoscope().tip()) > blade_in;
}

bool glottis_is_seen(const LessonState& sight) {
    return sight.scene.measures().glottic_opening_percent >= seen_percent;
}

bool tube_is_in(const LessonState& sight) {
    const auto& metrics = sight.scene.metrics();
    return metrics && metrics->tube_place() == msg::TUBE_IN_TRACHEA &&
           sight.scene.measures().tube_depth_past_glottis > tube_in;
}

bool attempt_succeeded(const LessonState& sight) {
    const auto& report = sight.scene.attempt_report();
    return report && (report->outcome.success || !report->outcome.known);  // a manikin does not measure the
                                                                           // outcome
}

constexpr std::size_t blade_lesson = 1;
constexpr std::array lesson_table{
    Lesson{translatable("1 of 5: look"),
           translatable("Press 2: the section view shows where the tools are. 5 is your own eye, 3 the "
                        "camera on the blade."),
           shows_inside},
    Lesson{
        translatable("2 of 5: blade in"),
        translatable(
            "Drag with the left button to move the blade's tip in at the right corner of the mouth and over "
            "the tongue. Drag with the right button to swing the handle back to the gum, and go down behind "
            "the tongue."),
        blade_is_in},
    Lesson{translatable("3 of 5: sweep and lift"),
           translatable(
               "Press 5 and drag the blade to the middle: it sweeps the tongue aside. Press 2, bring the tip "
               "beneath the epiglottis and lift along the handle with w until the glottis is visible. Do not "
               "lever on the gum."),
           glottis_is_seen},
    Lesson{
        translatable("4 of 5: tube through the cords"),
        translatable(
            "Tab takes the tube. Bring its tip to the mouth, advance it with the wheel, aim by dragging, and "
            "pass it through the cords under direct vision until the black band lies between them."),
        tube_is_in},
    Lesson{translatable("5 of 5: the result"),
           translatable(
               "Tab takes the blade. Lower it with q, withdraw it with the wheel, and leave the tube in "
               "place."),
           attempt_succeeded}};

}  // namespace

std::span<const Lesson> lessons() {
    return lesson_table;
}

void Tutorial::update(const LessonState& sight) {
    const auto& report = sight.scene.attempt_report();
    if (report && report->attempt != attempts_judged_) {
        attempts_judged_ = report->attempt;
        const bool failed = report->outcome.known && !report->outcome.success;
        failed_ = failed ? report->outcome.reason : "";
        if (failed && !finished() && lesson_ > blade_lesson) {
            lesson_ = blade_lesson;
        }
    }
    while (!finished() && lesson_table[lesson_].done(sight)) {
        ++lesson_;
        failed_.clear();
    }
}

void Tutorial::skip() {
    lesson_ += finished() ? 0 : 1;
    failed_.clear();
}

void Tutorial::add_to(hud::Readout& readout) const {
    if (finished()) {
        return;
    }
    readout.guidance.emplace_back(text::translate(lesson_table[lesson_].title));
    if (!failed_.empty()) {
        readout.guidance.push_back(
            text::translate_format("That attempt: {}. Try again.", text::translate_sentence(failed_)));
    }
    readout.guidance.emplace_back(text::translate(lesson_table[lesson_].text));
    readout.guidance.emplace_back(text::translate("Enter skips a step; h lists all keys."));
}

std::filesystem::path tutorial_marker_file() {
    const char* const settings = std::getenv("XDG_CONFIG_HOME");
    const char* const home = std::getenv("HOME");
    // The specification requires relative paths to be ignored.
    std::filesystem::path folder = settings != nullptr ? settings : "";
    if (!folder.is_absolute()) {
        folder = std::filesystem::path(home != nullptr ? home : "/") / ".config";
    }
    return folder / "neoeti" / "tutorial-shown";
}

bool tutorial_was_shown() {
    std::error_code error;
    return std::filesystem::exists(tutorial_marker_file(), error);
}

void mark_tutorial_shown() {
    std::error_code error;
    std::filesystem::create_directories(tutorial_marker_file().parent_path(), error);
    std::ofstream(tutorial_marker_file())
        << "The client's tutorial has been shown. Delete this file to show it again.\n";
}

}  // namespace eti::client
