// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <span>

struct ImFont;
struct ImFontAtlas;

namespace eti::hud {

/// The scalable font of all texts: DejaVu Sans of Debian's fonts-dejavu-core, searched for in the font
/// folders of the XDG Base Directory Specification and of other distributions. Empty if it is not installed.
[[nodiscard]] const std::filesystem::path& letters_file();
/// The same search in given font folders, the first first.
[[nodiscard]] std::filesystem::path find_letters(std::span<const std::filesystem::path> folders);

/// Warns, once per program, if the font is not installed, with the remedy. Texts then use Dear ImGui's bitmap
/// font, which has no letters beyond Latin-1.
void report_missing_letters();

/// Adds letters of this height [pixels] to an atlas, for all languages of client/text.
ImFont* add_letters(ImFontAtlas& atlas, int height);

}  // namespace eti::hud
