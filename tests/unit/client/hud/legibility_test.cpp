// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

// Legibility of the overlay in every language: contrast over any picture, letters that the font has, and
// texts that stay in their boxes.
#include <epoxy/gl.h>
#include <gtest/gtest.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "client/hud/hud.hpp"
#include "client/hud/letters.hpp"
#include "client/render/gl/headless_context.hpp"
#include "client/render/gl/render_target.hpp"
#include "client/text/catalogue.hpp"
#include "client/text/server_sentences.hpp"
#include "tests/support/drawn_text.hpp"

namespace eti {
namespace {

using hud::Level;

constexpr int frame_width = 960, frame_height = 540;

// A picture to draw over: plain, striped, noisy, or one of the documents' pictures.
render::Image background(int frame) {
    std::mt19937 random(static_cast<unsigned>(frame));
    const auto byte = [&] { return static_cast<std::uint8_t>(random() & 0xffu); };
    using Colour = std::array<std::uint8_t, 3>;
    // The extremes; then skin, gum, wet mucosa, the overlay's own red, highlights.
    constexpr std::array fixed{Colour{255, 255, 255}, Colour{0, 0, 0},      Colour{238, 190, 170},
                               Colour{200, 97, 106},  Colour{120, 20, 20},  Colour{255, 116, 102},
                               Colour{255, 246, 240}, Colour{128, 128, 128}};
    render::Image out{frame_width, frame_height,
                      std::vector<std::uint8_t>(4ull * frame_width * frame_height)};
    const Colour one = frame < static_cast<int>(fixed.size()) ? fixed[static_cast<std::size_t>(frame)]
                                                              : Colour{byte(), byte(), byte()};
    const Colour other{byte(), byte(), byte()};
    const int kind = frame < static_cast<int>(fixed.size()) ? 0 : frame % 4,
              period = 1 + static_cast<int>(random() % 24);
    for (int y = 0; y < frame_height; ++y) {
        for (int x = 0; x < frame_width; ++x) {
            std::uint8_t* const p = out.rgba.data() + 4ull * static_cast<std::size_t>(y * frame_width + x);
            const float share = static_cast<float>(x + y) / (frame_width + frame_height);
            for (std::size_t c = 0; c < 3; ++c) {
                p[c] = kind == 0   ? one[c]
                       : kind == 1 ? ((x / period + y / period) % 2 == 0 ? one[c] : other[c])
                       : kind == 2 ? byte()
                                   : static_cast<std::uint8_t>((1.0f - share) * one[c] + share * other[c]);
            }
            p[3] = 255;
        }
    }
    return out;
}

// Into the bound framebuffer, scaled to its size.
void paint(const render::Image& image, int width, int height) {
    GLint target = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
    GLuint texture = 0, source = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 image.rgba.data());
    glGenFramebuffers(1, &source);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, source);
    glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    glBlitFramebuffer(0, image.height, image.width, 0, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
    glDeleteFramebuffers(1, &source);
    glDeleteTextures(1, &texture);
}

// Everything that can be shown at once, with the longest texts; the levels change with `variant`.
hud::Readout full_readout(int variant) {
    hud::Readout out;
    out.link = variant % 3 == 0   ? hud::ServerLink::running
               : variant % 3 == 1 ? hud::ServerLink::finished
                                  : hud::ServerLink::lost;
    out.time_s = 83.4;
    out.attempt = variant % 4 == 0 ? 0 : 2;
    out.attempt_running = variant % 2 == 0;
    out.airway_measured = variant % 7 != 3;
    out.measures.gum_force_n = 1.0f + 2.0f * static_cast<float>(variant % 3);
    out.measures.glottic_opening_percent = 40.0f;
    out.measures.tube_depth_past_glottis = variant % 2 == 0 ? 0.012f : -0.01f;
    out.blade_depth_cm = variant % 5 == 0 ? 0.0f : 5.1f;
    out.behind_s = variant % 2 == 0 ? 12.0f : 0.0f;
    out.server_load = 1.2f;
    out.vital_signs = {{78.0, 96.0}};
    out.clock = {{31.7 - 5.0 * (variant % 3), 30.0}};
    out.tube_depth = {{8.8, 9.5}};
    out.message = text::translate("waiting for the server");
    if (variant % 2 == 0) {
        out.alarms = {std::string(text::translate("tube in a main bronchus"))};
    } else {
        out.verdict = {
            {.title = text::translate_format("attempt {}: {}", 2, text::translate("no success")),
             .level = Level::bad,
             .reason = text::translate_sentence(
                 "the tube's tip lies only 2 mm past the glottis, and 5 mm are required; it took "
                 "83.4 s, over the limit of 30 s"),
             .numbers = {{std::string(text::translate("force on the upper gum, maximum")), "12.3 N"},
                         {std::string(text::translate("glottic opening seen, maximum")), "41.0 %"},
                         {std::string(text::translate("tube depth by the weight rule")), "9.5 cm"}}}};
    }
    return out;
}

class Legibility : public ::testing::Test {
  protected:
    ~Legibility() override { text::set_language("en"); }

    std::vector<test::DrawnLine> draw(const hud::Readout& readout, int width, int height,
                                      const render::Image& beneath) {
        render::RenderTarget target(width, height, 1);
        target.bind_picture();
        paint(beneath, width, height);
        const hud::Tile tile{"laryngoscope", 0, 0, width, height};
        overlay_.draw(readout, {&tile, 1}, width, height);
        picture_ = target.read();
        return test::drawn_lines();
    }

    render::HeadlessContext context_;
    hud::Hud overlay_;
    render::Image picture_;
};

// WCAG 2.1, level AA, for text of any size.
TEST_F(Legibility, ContrastIsSufficientOverAnyPicture) {
    std::vector<std::filesystem::path> pictures;
    for (const auto& entry : std::filesystem::directory_iterator(ETI_PICTURES)) {
        if (entry.path().extension() == ".png") {
            pictures.push_back(entry.path());
        }
    }
    std::ranges::sort(pictures);
    constexpr int synthetic_frames = 200;
    double least = 21.0;
    std::size_t lines = 0;
    for (int frame = 0; frame < synthetic_frames + static_cast<int>(pictures.size()); ++frame) {
        const auto& languages = text::languages();
        text::set_language(languages[static_cast<std::size_t>(frame) % languages.size()].code);
        const render::Image beneath =
            frame < synthetic_frames
                ? background(frame)
                : render::read_png(pictures[static_cast<std::size_t>(frame - synthetic_frames)]);
        for (const test::DrawnLine& line : draw(full_readout(frame), frame_width, frame_height, beneath)) {
            const double contrast = test::contrast(line, picture_);
            EXPECT_GE(contrast, 4.5) << "frame " << frame << ": " << line.text;
            least = std::min(least, contrast);
            ++lines;
        }
    }
    EXPECT_GT(lines, 2000u);
    RecordProperty("least_contrast", std::to_string(least));
    std::printf("least contrast %.2f of %zu lines\n", least, lines);
}

TEST_F(Legibility, TextsStayInTheirBoxesInAllLanguages) {
    const render::Image beneath = background(0);
    for (const text::Language& language : text::languages()) {
        text::set_language(language.code);
        for (const auto& [width, height] : {std::pair{960, 540}, {1280, 720}}) {
            for (int variant = 0; variant < 12; ++variant) {
                const auto lines = draw(full_readout(variant), width, height, beneath);
                const std::string where = std::string(language.code) + ", " + std::to_string(width);
                EXPECT_EQ(test::overlapping(lines), "") << where;
                for (const test::DrawnLine& line : lines) {
                    const bool boxed = std::ranges::any_of(overlay_.boxes(), [&](const hud::Box& box) {
                        return Eigen::AlignedBox2f(box.low, box.high).contains(line.box);
                    });
                    EXPECT_TRUE(boxed) << where << ": " << line.text;
                }
                // The face is in the middle of every view.
                const hud::Box face{{0.25f * static_cast<float>(width), 0.25f * static_cast<float>(height)},
                                    {0.75f * static_cast<float>(width), 0.75f * static_cast<float>(height)}};
                EXPECT_FALSE(overlay_.verdict_box() && overlay_.verdict_box()->meets(face)) << where;
                for (const hud::Box& box : overlay_.boxes()) {
                    EXPECT_TRUE(
                        box.within({{0.0f, 0.0f}, {static_cast<float>(width), static_cast<float>(height)}}))
                        << where;
                }
            }
        }
    }
}

TEST_F(Legibility, FontHasTheLettersOfAllLanguages) {
    ASSERT_FALSE(hud::letters_file().empty()) << "install fonts-dejavu-core";
    ImFontAtlas atlas;
    const ImFont* const font = hud::add_letters(atlas, 14);
    ASSERT_TRUE(atlas.Build());
    for (const text::Language& language : text::languages()) {
        text::set_language(language.code);
        for (const auto& [english, translated] : text::entries()) {
            const char* at = translated.data();
            const char* const end = at + translated.size();
            while (at < end) {
                unsigned letter = 0;
                at += ImTextCharFromUtf8(&letter, at, end);
                EXPECT_TRUE(letter < 0x20 ||
                            font->FindGlyphNoFallback(static_cast<ImWchar>(letter)) != nullptr)
                    << language.code << ": U+" << std::hex << letter << " in " << translated;
            }
        }
    }
}

TEST(Letters, AreSearchedInFontFolders) {
    const auto folder = std::filesystem::path(::testing::TempDir()) / "letters-search";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder / "second/dejavu-sans-fonts");
    const std::array folders{folder / "first", folder / "second"};
    EXPECT_TRUE(hud::find_letters(folders).empty());
    const auto file = folder / "second/dejavu-sans-fonts/DejaVuSans.ttf";
    std::ofstream(file) << "letters";
    EXPECT_EQ(hud::find_letters(folders), file);
    std::filesystem::remove_all(folder);
}

TEST(Letters, GrowWithPictureAndUserScale) {
    EXPECT_EQ(hud::letter_height(640, 360), 13);
    EXPECT_EQ(hud::letter_height(1280, 720), 18);
    EXPECT_EQ(hud::letter_height(1080, 1920), 27);
    EXPECT_EQ(hud::letter_height(1280, 720, 2.0f), 36);
}

}  // namespace
}  // namespace eti
