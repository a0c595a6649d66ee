// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/panel/panel_renderer.hpp"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/render/image.hpp"
#include "client/text/catalogue.hpp"
#include "panel_scene.hpp"
#include "tests/support/drawn_text.hpp"
#include "tests/support/golden.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;
using test::PanelScene;

Presets two_presets() {
    Presets out;
    out.all.push_back(
        parse_preset("description: A large stiff tongue\nset:\n  tongue_scale: 1.2\n", "large.yaml"));
    out.all.push_back(parse_preset("description: As usual\nset:\n  tongue_scale: 1.0\n", "usual.yaml"));
    return out;
}

class PanelDrawing : public ::testing::Test {
  protected:
    void draw(int width = 1280, int height = 720) {
        render::RenderTarget target(width, height, 1);
        target.bind_picture();
        glClearColor(0.2f, 0.3f, 0.4f, 1.0f);
        glClear(GL_COLOR_BUFFER_BIT);
        one_.now += 16ms;
        drawing_.draw(one_.model, width, height, one_.now);
        picture_ = target.read();
    }
    // A page is selected in one picture, laid out in the next, and has its scroll bar in the third.
    void draw_settled(int width = 1280, int height = 720) {
        for (int i = 0; i < 3; ++i) {
            draw(width, height);
        }
    }
    void click(std::string_view control) {
        const auto place = drawing_.place(control);
        ASSERT_TRUE(place) << control << " is nowhere";
        press_at(static_cast<float>(place->x) + 0.5f * static_cast<float>(place->width),
                 static_cast<float>(place->y) + 0.5f * static_cast<float>(place->height));
    }
    void press_at(float x, float y) {
        for (const bool down : {false, true, false}) {
            drawing_.set_pointer({x, y, down});
            draw();
        }
    }
    // A minute in which the blade presses, the glottis is seen, and the tube is inserted.
    void live_a_minute() {
        for (int i = 0; i < 700; ++i) {
            const auto t = 0.1f * static_cast<float>(i);
            one_.gum_force = 2.5f + 2.5f * std::sin(0.4f * t);
            one_.opening = 50.0f + 40.0f * std::sin(0.2f * t);
            one_.tube_depth = -0.03f + 0.001f * t;
            one_.load = 0.6f + 0.1f * std::sin(2.0f * t);
            one_.say(0.1);
        }
    }

    render::HeadlessContext context_;
    PanelScene one_{true, two_presets()};
    panel::PanelRenderer drawing_;
    render::Image picture_;
};

TEST(PanelArea, TextHeightScalesWithScreenHeight) {
    for (const auto& [width, height] :
         {std::pair{1280, 720}, std::pair{1920, 1080}, std::pair{3840, 2160}, std::pair{720, 1280}}) {
        EXPECT_GE(panel::text_height(height), 0.02 * height);
        const panel::Area panel = panel::panel_area(width, height), scene = panel::scene_area(width, height);
        EXPECT_EQ(panel.width * panel.height + scene.width * scene.height, width * height);
        // Wide enough for a line of a slider: 27 letter heights.
        EXPECT_GE(panel.width, 27 * panel::text_height(height)) << width << " x " << height;
    }
    EXPECT_EQ(panel::panel_area(1280, 720).x, 1280 - 27 * 15) << "beside the scene";
    EXPECT_EQ(panel::panel_area(720, 1280).y, 640) << "below the scene";
}

TEST_F(PanelDrawing, DoesNotDrawOverScene) {
    one_.say();
    draw_settled();
    const panel::Area scene = panel::scene_area(1280, 720);
    const std::uint8_t* const first = picture_.pixel(0, 0);
    for (int y = 0; y < scene.height; y += 7) {
        for (int x = 0; x < scene.width; x += 7) {
            ASSERT_EQ(picture_.pixel(x, y)[0], first[0]) << x << ", " << y;
        }
    }
    EXPECT_NE(picture_.pixel(scene.width + 2, 2)[2], first[2]);
}

TEST_F(PanelDrawing, SliderClickRequestsValueAtPointer) {
    one_.say();
    draw_settled();
    const auto place = drawing_.place("tongue_scale");
    ASSERT_TRUE(place);
    press_at(static_cast<float>(place->x + place->width) - 2.0f, static_cast<float>(place->y) + 5.0f);
    ASSERT_NE(one_.at("tongue_scale").wanted, std::nullopt);
    EXPECT_FLOAT_EQ(*one_.at("tongue_scale").wanted, 1.4f);
    click("start of tongue_scale");
    EXPECT_FLOAT_EQ(*one_.at("tongue_scale").wanted, 1.0f);
}

TEST_F(PanelDrawing, PaperSlidersAreVisibleAndOthersSearchable) {
    one_.say();
    for (const auto& [width, height] :
         {std::pair{1280, 720}, std::pair{1920, 1080}, std::pair{2560, 1080}, std::pair{3840, 2160}}) {
        draw_settled(width, height);
        for (const panel::ParameterRow& row : one_.model.rows()) {
            if (row.group == panel::Group::published) {
                EXPECT_TRUE(drawing_.place(row.name)) << row.name << " at " << width << " x " << height;
            }
        }
    }
    for (const panel::ParameterRow& row : one_.model.rows()) {
        one_.model.search = row.label;
        draw_settled();
        EXPECT_TRUE(drawing_.place(row.name)) << row.name;
    }
}

// In a headset, at the panel's size there.
TEST_F(PanelDrawing, HeadsetSearchUsesOnScreenKeyboard) {
    const auto draw_full_screen = [&] {
        render::RenderTarget target(540, 640, 1);
        target.bind_picture();
        glClear(GL_COLOR_BUFFER_BIT);
        drawing_.draw_full_screen(one_.model, 540, 640, one_.now += 16ms);
        picture_ = target.read();
    };
    const auto point_at = [&](std::string_view control) {
        const auto place = drawing_.place(control);
        ASSERT_TRUE(place) << control << " is nowhere";
        for (const bool down : {false, true, false}) {
            drawing_.set_pointer({static_cast<float>(place->x) + 0.5f * static_cast<float>(place->width),
                                  static_cast<float>(place->y) + 0.5f * static_cast<float>(place->height),
                                  down});
            draw_full_screen();
        }
    };
    one_.say();
    draw_full_screen();
    draw_full_screen();
    EXPECT_FALSE(drawing_.place("key a")) << "keys that nobody wants are in the way";
    point_at("search");
    draw_full_screen();
    for (const char* const key :
         {"key t", "key u", "key b", "key x", "key back", "key e", "key space", "key s"}) {
        point_at(key);
    }
    EXPECT_EQ(one_.model.search, "tube s");
    draw_full_screen();
    const auto key = drawing_.place("key s");
    EXPECT_GT(picture_.pixel(key->x + key->width / 2, key->y + key->height / 2)[1], 200)
        << "no white pointer";
    EXPECT_TRUE(drawing_.place("tube_youngs_modulus"));
    EXPECT_FALSE(drawing_.place("jaw_opening"));
    // Keys are large enough for a trembling hand: 36 mm in the room are 2.3 deg.
    EXPECT_GE(drawing_.place("key a")->width, 36);
    EXPECT_GE(drawing_.place("key a")->height, 36);
    EXPECT_LE(drawing_.place("key done")->y + drawing_.place("key done")->height, 640);
    point_at("key clear");
    EXPECT_EQ(one_.model.search, "");
    point_at("key done");
    draw_full_screen();
    EXPECT_FALSE(drawing_.place("key a"));
    EXPECT_TRUE(drawing_.place("jaw_opening"));
}

TEST_F(PanelDrawing, WindowHasNoOnScreenKeyboard) {
    one_.say();
    draw_settled();
    click("search");
    draw();
    EXPECT_FALSE(drawing_.place("key a"));
}

TEST_F(PanelDrawing, TabChangesPageAndSwitchRequestsAid) {
    one_.say();
    draw_settled();
    click("Aids");
    EXPECT_EQ(one_.model.page, panel::Page::aids);
    draw();
    click("view_axes");
    EXPECT_EQ(one_.at("view_axes").wanted, 1.0f);
    EXPECT_TRUE(drawing_.has_mouse());
    drawing_.set_pointer({10.0f, 10.0f, false});
    draw();
    EXPECT_FALSE(drawing_.has_mouse());
}

TEST_F(PanelDrawing, PresetIsSelectedFromList) {
    one_.say();
    draw_settled();
    click("preset");
    draw();
    click("preset large");
    ASSERT_NE(one_.model.chosen(), nullptr);
    EXPECT_EQ(one_.model.chosen()->name, "large");
    EXPECT_EQ(one_.at("tongue_scale").wanted, 1.2f);
}

TEST_F(PanelDrawing, StopRequiresConfirmation) {
    one_.say();
    one_.model.page = panel::Page::session;
    draw_settled();
    click("Stop ...");
    one_.model.update(one_.now);
    EXPECT_TRUE(one_.sent.empty());
    draw();
    click("Cancel");
    draw();
    EXPECT_FALSE(drawing_.place("Stop the session"));
    click("Stop ...");
    draw();
    click("Stop the session");
    one_.model.update(one_.now);
    ASSERT_EQ(one_.sent.size(), 1u);
    EXPECT_EQ(one_.sent[0].first, "stop");
    click("Reset");
    one_.model.update(one_.now);
    EXPECT_EQ(one_.sent.back().first, "reset");
}

TEST_F(PanelDrawing, TakesKeyboardOnlyIfOpenedByKey) {
    one_.say();
    draw_settled();
    EXPECT_FALSE(drawing_.has_keyboard()) << "shown from the start";
    drawing_.focus_keyboard();
    draw_settled();
    EXPECT_TRUE(drawing_.has_keyboard());
}

TEST_F(PanelDrawing, ObserverPanelIgnoresClicks) {
    PanelScene watching(false);
    watching.say();
    render::RenderTarget target(1280, 720, 1);
    const auto look = [&](const panel::Pointer& pointer) {
        target.bind_picture();
        drawing_.set_pointer(pointer);
        drawing_.draw(watching.model, 1280, 720, watching.now += 16ms);
    };
    look({});
    look({});
    const auto slider = drawing_.place("tongue_scale");
    ASSERT_TRUE(slider);
    for (const bool down : {false, true, false}) {
        look({static_cast<float>(slider->x + slider->width) - 2.0f, static_cast<float>(slider->y) + 5.0f,
              down});
    }
    EXPECT_EQ(watching.at("tongue_scale").wanted, std::nullopt);
    EXPECT_FALSE(drawing_.place("preset"));
    watching.model.page = panel::Page::session;
    look({});
    look({});
    EXPECT_FALSE(drawing_.place("Reset"));
}

TEST_F(PanelDrawing, StaleNumbersAreDimmed) {
    live_a_minute();
    one_.model.page = panel::Page::health;
    const auto brightest = [&] {
        // Below the heading, which gives the reason.
        int most = 0;
        for (int y = 100; y < picture_.height; ++y) {
            for (int x = panel::scene_area(1280, 720).width; x < picture_.width; ++x) {
                most = std::max<int>(most, picture_.pixel(x, y)[1]);
            }
        }
        return most;
    };
    draw_settled();
    const int fresh = brightest();
    one_.now += 5s;
    draw_settled();
    EXPECT_LT(brightest(), 0.65 * fresh);
}

class PanelPage : public PanelDrawing, public ::testing::WithParamInterface<panel::Page> {
  protected:
    std::vector<test::DrawnLine> lines() {
        const auto use = drawing_.make_current();
        return test::drawn_lines();
    }
};

// Beside the scene, below it, and in a headset.
TEST_P(PanelPage, TextIsCompleteLegibleAndApart) {
    live_a_minute();
    one_.connection = {4.2, 11.0, 5400, 3, 12, 11, 1, false, {"eti-server lab:100", "eti-haptics lab:101"}};
    one_.say();
    one_.model.request(one_.row("table_angle"), -10.0f);
    const bus::Refusal refusals[] = {{"secretion",
                                      "there is no liquid in this scenario; restart it with 'saliva: "
                                      "standby', which starts without saliva"}};
    one_.model.note_refusals(refusals);
    one_.model.page = GetParam();
    std::vector<std::string> expected{std::string(panel::title(GetParam())), "synthetic", "running, 71.0 s"};
    switch (GetParam()) {
        case panel::Page::patient:
            expected.insert(expected.end(), {"tongue scale 0.8 to 1.4 1.00 1.00", "~ -10.0 deg",
                                             "restart it with 'saliva: standby', which starts without"});
            break;
        case panel::Page::aids:
            for (const panel::ParameterRow& row : one_.model.rows()) {
                if (row.group == panel::Group::aids) {
                    expected.push_back(row.label + ' ' + row.help);
                }
            }
            break;
        case panel::Page::session:
            expected.insert(expected.end(), {"made by a test", "Start Reset Next scenario Stop ..."});
            break;
        case panel::Page::plots:
            for (const panel::Series& series : one_.model.history().series()) {
                if (!series.samples.empty()) {
                    expected.push_back(fmt::format("{} [{}] {:.1f} {:g} to {:.3g} last 60 s",
                                                   series.field->short_label, series.field->unit,
                                                   series.samples.back().value, series.low(), series.high()));
                }
            }
            break;
        case panel::Page::health:
            for (const panel::HealthLine& line : one_.model.health()) {
                expected.push_back(line.label + ' ' + line.value);
            }
            break;
    }
    for (const auto& [width, height] : {std::pair{1280, 720}, std::pair{720, 1280}}) {
        draw_settled(width, height);
        const std::vector<test::DrawnLine> drawn = lines();
        const std::string all = test::sentence(drawn);
        for (const std::string& words : expected) {
            // In half the height a page is scrolled.
            EXPECT_TRUE(height > width || all.find(words) != std::string::npos)
                << "'" << words << "' is not in: " << all;
        }
        EXPECT_EQ(test::overlapping(drawn), "");
        for (const test::DrawnLine& line : drawn) {
            // Pages scroll up and down only; antialiasing widens a letter by up to a pixel.
            EXPECT_GE(line.box.min().x(), line.clip.min().x() - 1.0f) << line.text;
            EXPECT_LE(line.box.max().x(), line.clip.max().x() + 1.0f) << line.text;
            EXPECT_TRUE(!line.clip.contains(line.box) || test::contrast(line, picture_) >= 3.0) << line.text;
        }
    }
}

TEST_P(PanelPage, TextFitsInEveryLanguage) {
    live_a_minute();
    one_.say();
    one_.model.page = GetParam();
    // As drawn_lines() has it: any letter beyond ASCII is a tilde.
    const auto plain = [](std::string_view words) {
        std::string out;
        for (const char c : words) {
            const auto byte = static_cast<unsigned char>(c);
            out += byte < 0x80 ? std::string(1, c) : (byte & 0xc0u) == 0xc0u ? "~" : "";
        }
        return out;
    };
    for (const text::Language& language : text::languages()) {
        text::set_language(language.code);
        for (const auto& [width, height] : {std::pair{960, 540}, std::pair{1280, 720}}) {
            draw_settled(width, height);
            const std::vector<test::DrawnLine> drawn = lines();
            EXPECT_EQ(test::overlapping(drawn), "") << language.code << ", " << width;
            for (const test::DrawnLine& line : drawn) {
                EXPECT_LE(line.box.max().x(), line.clip.max().x() + 1.0f)
                    << language.code << ", " << width << ": " << line.text;
            }
            for (const panel::Page page : panel::pages) {  // tabs are not cut off
                const std::string title = plain(text::translate(panel::title(page)));
                EXPECT_NE(test::sentence(drawn).find(title), std::string::npos)
                    << language.code << ", " << width << ": " << title;
            }
        }
    }
    text::set_language("en");
}

INSTANTIATE_TEST_SUITE_P(Pages, PanelPage, ::testing::ValuesIn(panel::pages),
                         [](const auto& one) { return std::string(panel::title(one.param)); });

// The curves, their limits and the lines of 15 s: one pixel in a thousand may differ at edges.
TEST_F(PanelDrawing, PlotsMatchReferenceImage) {
    live_a_minute();
    one_.connection = {4.2, 11.0, 5400, 3, 12, 11, 1, false, {"eti-server lab:100", "eti-haptics lab:101"}};
    one_.say();
    one_.model.page = panel::Page::plots;
    draw_settled();
    EXPECT_TRUE(test::matches_golden(picture_, std::filesystem::path(ETI_GOLDEN) / "Plots.png", 1e-3));
}

}  // namespace
}  // namespace eti
