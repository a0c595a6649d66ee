// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/options.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "client/app/tutorial.hpp"
#include "client/text/catalogue.hpp"
#include "common/math/units.hpp"

namespace eti {
namespace {

std::optional<int> parse(std::initializer_list<const char*> arguments, client::Options& options) {
    ::setenv("LANGUAGE", "en", 1);  // of the texts that other tests expect
    std::vector<char*> argv{const_cast<char*>("eti-client")};
    for (const char* argument : arguments) {
        argv.push_back(const_cast<char*>(argument));
    }
    return client::parse(static_cast<int>(argv.size()), argv.data(), options);
}

TEST(Options, OnlyOffscreenTraineeRecordsVideoByDefault) {
    client::Options trainee;
    ASSERT_FALSE(parse({"--offscreen", "pics"}, trainee));
    EXPECT_EQ(trainee.video, "pics/session.mp4");
    EXPECT_EQ(trainee.selection, &client::default_selection());
    client::Options observer;
    ASSERT_FALSE(parse({"--offscreen", "pics", "--observe"}, observer));
    EXPECT_TRUE(observer.video.empty());
    client::Options silent;
    ASSERT_FALSE(parse({"--offscreen", "pics", "--no-video"}, silent));
    EXPECT_TRUE(silent.video.empty());
}

TEST(Options, LanguageTextScaleAndLoupeAreChosen) {
    client::Options options;
    ASSERT_FALSE(parse({"--language", "vi", "--text-scale", "1.5", "--loupe", "3"}, options));
    EXPECT_EQ(text::language(), "vi");
    EXPECT_EQ(options.text_scale, 1.5f);
    EXPECT_EQ(options.vantage.loupe.magnification, 3.0f);
    ASSERT_FALSE(parse({}, options));
    EXPECT_EQ(text::language(), "en");
    for (const auto& refused : {std::pair{"--language", "la"}, {"--text-scale", "4"}, {"--loupe", "0.5"}}) {
        EXPECT_EQ(parse({refused.first, refused.second}, options), 2) << refused.first;
    }
}

TEST(Options, InstructorHasFourViewsAndIsNotTrainee) {
    client::Options instructor;
    ASSERT_FALSE(parse({"--instructor"}, instructor));
    EXPECT_EQ(instructor.selection, &client::instructor_selection());
    EXPECT_FALSE(instructor.is_trainee());
    EXPECT_FALSE(instructor.observe);
    client::Options section;
    ASSERT_FALSE(parse({"--instructor", "--view", "section"}, section));
    EXPECT_EQ(section.selection, client::selection_named("section"));
    client::Options trainee;
    ASSERT_FALSE(parse({}, trainee));
    EXPECT_TRUE(trainee.is_trainee());
    for (const auto& both : std::vector<std::vector<const char*>>{{"--instructor", "--observe"},
                                                                  {"--instructor", "--view", "hmd"}}) {
        std::vector<char*> argv{const_cast<char*>("eti-client")};
        for (const char* argument : both) {
            argv.push_back(const_cast<char*>(argument));
        }
        client::Options refused;
        EXPECT_EQ(client::parse(static_cast<int>(argv.size()), argv.data(), refused), 2) << both.back();
    }
}

TEST(Options, ReadsSizeAndView) {
    client::Options options;
    ASSERT_FALSE(
        parse({"--size", "1280x720", "--view", "laryngoscope", "--session", "a", "--domain", "7"}, options));
    EXPECT_EQ(options.width, 1280);
    EXPECT_EQ(options.height, 720);
    EXPECT_EQ(options.selection, client::selection_named("laryngoscope"));
    EXPECT_EQ(options.bus.session, "a");
    EXPECT_EQ(options.bus.domain, 7);
}

TEST(Options, EyeOffsetPlacesTraineeEye) {
    client::Options options;
    ASSERT_FALSE(parse({"--eye-offset-mm", "10,-20.5,1e1"}, options));
    EXPECT_LT((options.vantage.eye.offset() - Vec3f(0.010f, -0.0205f, 0.010f)).norm(), 1e-7f);
    client::Options plain;
    ASSERT_FALSE(parse({}, plain));
    EXPECT_EQ(plain.vantage.eye.offset(), Vec3f::Zero());
}

TEST(Options, HeadsetViewPlacesPatientAndDominantEye) {
    client::Options plain;
    ASSERT_FALSE(parse({"--view", "hmd"}, plain));
    EXPECT_TRUE(plain.headset);
    EXPECT_FALSE(plain.left_eye_dominant);
    EXPECT_LT((plain.gum_in_room - hmd::Room().gum).norm(), 1e-6f) << "what help says is what is done";
    client::Options placed;
    ASSERT_FALSE(
        parse({"--view", "hmd", "--patient-at-mm", "10,-300,250", "--dominant-eye", "left"}, placed));
    EXPECT_LT((placed.gum_in_room - Vec3f(0.01f, -0.3f, -0.25f)).norm(), 1e-6f) << "ahead is -z";
    EXPECT_TRUE(placed.left_eye_dominant);
    client::Options window;
    ASSERT_FALSE(parse({}, window));
    EXPECT_FALSE(window.headset);
    ::testing::internal::CaptureStderr();
    client::Options both;
    EXPECT_EQ(parse({"--view", "hmd", "--offscreen", "pics"}, both), 2);
    EXPECT_NE(::testing::internal::GetCapturedStderr().find("--offscreen"), std::string::npos);
    for (const char* const text : {"0,0", "nan,0,0", "0,2001,0", ""}) {
        ::testing::internal::CaptureStderr();
        client::Options far;
        EXPECT_EQ(parse({"--patient-at-mm", text}, far), 2) << text;
        EXPECT_NE(::testing::internal::GetCapturedStderr().find("RIGHT,UP,AHEAD"), std::string::npos);
    }
}

TEST(Options, InvalidEyeOffsetErrorStatesRange) {
    for (const char* const text : {"nan,0,0", "0,inf,0", "1,2", "1,2,3,4", "1,2,", "251,0,0", "a,b,c", ""}) {
        client::Options options;
        ::testing::internal::CaptureStderr();
        const auto status = parse({"--eye-offset-mm", text}, options);
        const std::string said = ::testing::internal::GetCapturedStderr();
        ASSERT_TRUE(status) << text;
        EXPECT_NE(*status, 0);
        EXPECT_NE(said.find("X,Y,Z in mm, each from -250 to 250"), std::string::npos) << text << ": " << said;
    }
}

TEST(Options, ReadsSectionPlaneAndLensFogging) {
    client::Options options;
    ASSERT_FALSE(parse({"--section-plane", "5,-90,30", "--fogging", "0.5"}, options));
    const render::CutPlane plane = options.vantage.section.plane(zero_landmarks()),
                           wanted = render::Section(0.005f, -90.0f * degree, 30.0f * degree)
                                        .plane(zero_landmarks());
    EXPECT_LT((plane.normal - wanted.normal).norm() + (plane.origin - wanted.origin).norm(), 1e-6f);
    EXPECT_EQ(options.vantage.fogging, 0.5f);
    for (const char* const text : {"nan,0,0", "101,0,0", "0,181,0", "0,0,91", "5", ""}) {
        client::Options wrong;
        ::testing::internal::CaptureStderr();
        ASSERT_TRUE(parse({"--section-plane", text}, wrong)) << text;
        EXPECT_NE(::testing::internal::GetCapturedStderr().find("expected OFFSET,TURN,TILT"),
                  std::string::npos);
    }
    for (const char* const text : {"nan", "-0.1", "1.1", "much", ""}) {
        client::Options wrong;
        ASSERT_TRUE(parse({"--fogging", text}, wrong)) << text;
    }
}

TEST(Options, TutorialIsOnForFirstHandsRunOnly) {
    const auto folder =
        std::filesystem::temp_directory_path() / ("eti-options-" + std::to_string(::getpid()));
    ::setenv("XDG_CONFIG_HOME", folder.c_str(), 1);
    client::Options first, without, again, asked;
    ASSERT_FALSE(parse({"--hands"}, first));
    EXPECT_TRUE(first.hands && first.tutorial);
    ASSERT_FALSE(parse({}, without));
    EXPECT_FALSE(without.hands || without.tutorial);
    client::mark_tutorial_shown();
    ASSERT_FALSE(parse({"--hands"}, again));
    EXPECT_FALSE(again.tutorial);
    ASSERT_FALSE(parse({"--hands", "--tutorial", "on"}, asked));
    EXPECT_TRUE(asked.tutorial);
    std::filesystem::remove_all(folder);
    ::unsetenv("XDG_CONFIG_HOME");
    client::Options refused;
    EXPECT_EQ(parse({"--hands", "--observe"}, refused), 2);
    EXPECT_EQ(parse({"--hands", "--view", "hmd"}, refused), 2);
    EXPECT_EQ(parse({"--volume", "1.5"}, refused), 2);
}

TEST(Options, SoundIsAutomaticUnlessSet) {
    client::Options by_itself, on, off;
    ASSERT_FALSE(parse({}, by_itself));
    EXPECT_EQ(by_itself.sound, std::nullopt);
    ASSERT_FALSE(parse({"--sound", "on", "--volume", "0.25"}, on));
    EXPECT_EQ(on.sound, true);
    EXPECT_EQ(on.volume, 0.25f);
    ASSERT_FALSE(parse({"--sound", "off"}, off));
    EXPECT_EQ(off.sound, false);
}

TEST(Options, RejectsInvalidArguments) {
    const std::initializer_list<std::initializer_list<const char*>> mistakes = {
        {"--size", "640"},       {"--size", "641x480"},  {"--size", "0x0"},
        {"--size", "640x480x2"}, {"--size", "-640x480"}, {"--size", "999999x999998"},
        {"--view", "nowhere"},   {"--domain", "300"},    {"--every", "-1"},
        {"--fps", "0"},          {"--video", "a.mp4"},   {"--frames", "-3"},
        {"--profile", "absent"}, {"--quality", "best"},  {"--no-such-option"},
    };
    for (const auto& mistake : mistakes) {
        client::Options options;
        const auto status = parse(mistake, options);
        ASSERT_TRUE(status) << *mistake.begin() << " " << *(mistake.end() - 1);
        EXPECT_NE(*status, 0);
    }
}

}  // namespace
}  // namespace eti
