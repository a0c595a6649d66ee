// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/hud/letters.hpp"

#include <imgui.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace eti::hud {
namespace {

// Basic Latin to Latin Extended-A, then Vietnamese (horn letters and Latin Extended Additional), dashes,
// quotation marks and dots, arrows, comparison signs.
constexpr std::array<ImWchar, 15> letter_ranges{0x20,   0x17f,  0x1a0,  0x1b0,  0x1ea0,
                                                0x1ef9, 0x2010, 0x2026, 0x2190, 0x2193,
                                                0x2248, 0x2248, 0x2264, 0x2265, 0};
// Larger letters are smooth without oversampling, and their atlas stays small.
constexpr int oversampled_below = 24;  // [pixels]

std::vector<std::filesystem::path> font_folders() {
    const auto variable = [](const char* name, std::string otherwise) {
        const char* const value = std::getenv(name);
        return value != nullptr && *value != '\0' ? std::string(value) : otherwise;
    };
    std::vector<std::filesystem::path> out;
    if (const std::string home = variable("HOME", ""); !home.empty()) {
        out.emplace_back(std::filesystem::path(variable("XDG_DATA_HOME", home + "/.local/share")) / "fonts");
    }
    const std::string shared = variable("XDG_DATA_DIRS", "/usr/local/share:/usr/share");
    for (std::size_t begin = 0; begin <= shared.size();) {
        const std::size_t end = std::min(shared.find(':', begin), shared.size());
        out.emplace_back(std::filesystem::path(shared.substr(begin, end - begin)) / "fonts");
        begin = end + 1;
    }
    out.emplace_back("/usr/share/fonts");
    return out;
}

}  // namespace

std::filesystem::path find_letters(std::span<const std::filesystem::path> folders) {
    for (const std::filesystem::path& folder : folders) {
        // Debian, Fedora, Arch, and a user's own folder.
        for (const char* const below : {"truetype/dejavu", "dejavu-sans-fonts", "TTF", "dejavu", ""}) {
            const auto file = folder / below / "DejaVuSans.ttf";
            std::error_code error;
            if (std::filesystem::is_regular_file(file, error)) {
                return file;
            }
        }
    }
    return {};
}

const std::filesystem::path& letters_file() {
    static const std::filesystem::path file = find_letters(font_folders());
    return file;
}

void report_missing_letters() {
    static const bool reported = [] {
        if (letters_file().empty()) {
            spdlog::warn(
                "font DejaVuSans.ttf not found in the font folders of XDG_DATA_HOME and XDG_DATA_DIRS; texts "
                "are coarse and in English. Remedy: apt install fonts-dejavu-core");
        }
        return true;
    }();
    (void)reported;
}

ImFont* add_letters(ImFontAtlas& atlas, int height) {
    ImFontConfig config;
    config.SizePixels = static_cast<float>(height);
    if (letters_file().empty()) {
        return atlas.AddFontDefault(&config);
    }
    config.OversampleH = height < oversampled_below ? 2 : 1;
    config.PixelSnapH = true;
    config.RasterizerMultiply = 1.25f;  // thin strokes keep their contrast
    return atlas.AddFontFromFileTTF(letters_file().c_str(), config.SizePixels, &config, letter_ranges.data());
}

}  // namespace eti::hud
