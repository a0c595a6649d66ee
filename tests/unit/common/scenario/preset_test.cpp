// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/scenario/preset.hpp"
#include "common/scenario/data_file.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <string>

#include "common/math/units.hpp"
#include "tests/support/error_of.hpp"

namespace eti {
namespace {

namespace fs = std::filesystem;

std::string preset_refusal(const std::string& text) {
    return test::error_of<InputError>([&] { (void)parse_preset(text, "hard.yaml"); });
}

TEST(Preset, ConvertsTypedValuesToSi) {
    const Preset preset = parse_preset(
        "description: Little room\n"
        "set:\n"
        "  jaw_opening_deg: 20\n"
        "  view_axes: on\n"
        "  tissue_stiffness_kpa: 12.5\n",
        "little_room.yaml");
    EXPECT_EQ(preset.name, "little_room");
    EXPECT_EQ(preset.description, "Little room");
    // In the order of the table of runtime parameters.
    ASSERT_EQ(preset.values.size(), 3u);
    EXPECT_EQ(preset.values[0].field->name, "jaw_opening");
    EXPECT_FLOAT_EQ(preset.values[0].value, 20.0f * degree);
    EXPECT_EQ(preset.values[1].field->name, "tissue_stiffness");
    EXPECT_FLOAT_EQ(preset.values[1].value, 12.5e3f);
    EXPECT_EQ(preset.values[2].field->name, "view_axes");
    EXPECT_EQ(preset.values[2].value, 1.0f);
}

TEST(Preset, ErrorsNamePlaceFindingAndExpectation) {
    const auto expect = [](const std::string& text, std::initializer_list<const char*> words) {
        const std::string said = preset_refusal(text);
        for (const char* word : words) {
            EXPECT_NE(said.find(word), std::string::npos) << said << "\nlacks " << word;
        }
    };
    expect("description: x\nset:\n  tongue_scale: 2\n",
           {"hard.yaml:3", "'set.tongue_scale'", "'2'", "0.8", "1.4"});
    expect("description: x\nset:\n  tonge_scale: 1\n", {"hard.yaml:3", "did you mean 'tongue_scale'?"});
    expect("description: x\nset:\n  view_axes: maybe\n", {"hard.yaml:3", "on or off"});
    expect("set:\n  tongue_scale: 1\n", {"hard.yaml", "'description'", "a sentence"});
    expect("description: x\n", {"'set'", "no values", "at least one"});
    expect("description: x\nset:\n  tongue_scale: 1\nweight_kg: 2\n",
           {"hard.yaml:4", "unknown key 'weight_kg'"});
    expect("description: x\nset:\n  tongue_scale: nan\n", {"hard.yaml:3", "'nan'"});
}

TEST(Preset, ShippedPresetsAreNamedLikeTheirFiles) {
    const Presets presets = load_presets();
    EXPECT_EQ(presets.errors, std::vector<std::string>{});
    std::set<std::string> files, names;
    for (const auto& entry : fs::directory_iterator(fs::path(ETI_SOURCE_DIR) / "deploy/data/presets")) {
        files.insert(entry.path().stem().string());
    }
    for (const Preset& preset : presets.all) {
        names.insert(preset.name);
    }
    EXPECT_EQ(names, files);
    EXPECT_GE(names.size(), 3u);
}

TEST(Preset, InvalidPresetDoesNotHideTheOthers) {
    const fs::path folder = fs::temp_directory_path() / ("eti-presets-" + std::to_string(::getpid()));
    fs::create_directories(folder / "presets");
    std::ofstream(folder / "presets/mine.yaml") << "description: Mine\nset:\n  suction: 1\n";
    std::ofstream(folder / "presets/odd.yaml") << "description: Odd\nset:\n  suction: much\n";
    ::setenv("ETI_DATA", folder.c_str(), 1);
    const Presets presets = load_presets();
    ::unsetenv("ETI_DATA");
    fs::remove_all(folder);
    EXPECT_TRUE(std::ranges::any_of(presets.all, [](const Preset& one) { return one.name == "mine"; }));
    ASSERT_EQ(presets.errors.size(), 1u);
    EXPECT_NE(presets.errors[0].find("odd.yaml:3"), std::string::npos) << presets.errors[0];
}

}  // namespace
}  // namespace eti
