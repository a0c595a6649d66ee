// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "common/math/random.hpp"
#include "common/operator/operator.hpp"
#include "common/scenario/scenario.hpp"

namespace eti {
namespace {

struct Shipped {
    std::filesystem::path file;
    std::string text;
    bool is_operator = false;
};

std::vector<Shipped> shipped() {
    std::vector<Shipped> all;
    for (const bool is_operator : {false, true}) {
        const char* folder =
            is_operator ? ETI_SOURCE_DIR "/deploy/data/operators" : ETI_SOURCE_DIR "/deploy/data/scenarios";
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            std::ifstream in(entry.path(), std::ios::binary);
            all.push_back({entry.path(), std::string(std::istreambuf_iterator<char>(in), {}), is_operator});
        }
    }
    return all;
}

// Parses the text; returns whether it was accepted. Any outcome other than acceptance or an InputError ends
// the test.
bool accepted(const Shipped& kind, const std::string& text) {
    try {
        if (kind.is_operator) {
            (void)parse_operator(text, kind.file);
        } else {
            (void)parse_scenario(text, kind.file);
        }
        return true;
    } catch (const InputError& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.rfind(kind.file.string(), 0), 0u) << "does not name the file: " << message;
        return false;
    }
}

TEST(Fuzz, TruncatedFilesAreRefusedOrWhole) {
    for (const Shipped& kind : shipped()) {
        ASSERT_TRUE(accepted(kind, kind.text)) << kind.file;
        std::size_t refused = 0;
        for (std::size_t length = 0; length < kind.text.size(); length += 3) {
            refused += accepted(kind, kind.text.substr(0, length)) ? 0 : 1;
        }
        // A cut inside a key, or behind a key and before its value, leaves no valid file.
        EXPECT_GT(refused, kind.text.size() / 30) << kind.file;
    }
}

TEST(Fuzz, DamagedBytesAreRefusedOrHarmless) {
    Random random(2020);
    for (const Shipped& kind : shipped()) {
        std::size_t refused = 0;
        for (int round = 0; round < 400; ++round) {
            std::string text = kind.text;
            for (int flips = 1 + static_cast<int>(random.bits() % 4); flips > 0; --flips) {
                char& byte = text[random.bits() % text.size()];
                // Bits, or the special characters of YAML.
                byte = round % 2 ? static_cast<char>(byte ^ (1 << random.bits() % 8))
                                 : "{}[],:#&*!|>'\"%@`?-\n \t~<="[random.bits() % 26];
            }
            refused += accepted(kind, text) ? 0 : 1;
        }
        EXPECT_GT(refused, 80u) << kind.file << ": damage goes unnoticed";
    }
}

TEST(Fuzz, SplicedFilesAreRefusedOrHarmless) {
    Random random(2021);
    const std::vector<Shipped> all = shipped();
    int refused = 0;
    for (int round = 0; round < 1000; ++round) {
        const Shipped& kind = all[random.bits() % all.size()];
        std::string text = kind.text;
        for (int splices = 1 + static_cast<int>(random.bits() % 3); splices > 0; --splices) {
            const std::string& other = all[random.bits() % all.size()].text;
            const std::size_t from = random.bits() % other.size();
            text.insert(random.bits() % text.size(), other.substr(from, random.bits() % 200));
        }
        refused += accepted(kind, text) ? 0 : 1;
    }
    // A piece of up to 200 letters rarely ends where a key does; pieces that are whole comments change
    // nothing.
    EXPECT_GT(refused, 800);
    EXPECT_LT(refused, 1000);
}

}  // namespace
}  // namespace eti
