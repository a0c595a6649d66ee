// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/sound/player.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "client/sound/tones.hpp"

namespace eti {
namespace {

using namespace std::chrono_literals;

// OpenAL Soft plays into a file, by its configuration: the loudspeaker signal.
class PlayerTest : public ::testing::Test {
  protected:
    void SetUp() override {
        std::filesystem::create_directories(folder_);
        std::ofstream(folder_ / "alsoft.conf")
            << "[general]\ndrivers = wave\nchannels = mono\nsample-type = int16\n"
            << "frequency = " << sound::sample_rate << "\n[wave]\nfile = " << (folder_ / "out.wav").string()
            << "\n";
        ::setenv("ALSOFT_CONF", (folder_ / "alsoft.conf").c_str(), 1);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::vector<float> heard() const {
        std::ifstream file(folder_ / "out.wav", std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        const std::size_t data = bytes.find("data");
        std::vector<float> out;
        for (std::size_t i = data + 8; data != std::string::npos && i + 1 < bytes.size(); i += 2) {
            const auto low = static_cast<unsigned char>(bytes[i]),
                       high = static_cast<unsigned char>(bytes[i + 1]);
            out.push_back(static_cast<float>(static_cast<std::int16_t>(low | (high << 8))) / 32768.0f);
        }
        return out;
    }

    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("eti-sound-" + std::to_string(::getpid()));
};

TEST_F(PlayerTest, PlaysBeepsAtSaturationPitch) {
    {
        const auto player = sound::Player::open(1.0f);
        ASSERT_NE(player, nullptr);
        player->set_cue({sound::Cue::Pulse{60.0, 150.0}, false, false});
        std::this_thread::sleep_for(1500ms);
    }
    const std::vector<float> samples = heard();
    ASSERT_GT(samples.size(), static_cast<std::size_t>(sound::sample_rate / 2));
    // Upward crossings of one hundredth, each after a fall below minus that: the library adds noise at the
    // last bit. Crossings less than 10 ms apart belong to one beep.
    bool below = false;
    std::size_t last = 0;
    double periods = 0.0, within = 0.0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
        below = below || samples[i] < -0.01f;
        if (below && samples[i] > 0.01f) {
            if (last > 0 && i - last < sound::sample_rate / 100) {
                periods += 1.0;
                within += static_cast<double>(i - last) / sound::sample_rate;
            }
            last = i;
            below = false;
        }
    }
    ASSERT_GT(periods, 100.0) << "three beeps of 50 periods";
    EXPECT_NEAR(periods / within, 440.0, 1.0);
}

TEST(Player, OpenReturnsNullWithoutDevice) {
    const auto folder =
        std::filesystem::temp_directory_path() / ("eti-no-sound-" + std::to_string(::getpid()));
    std::ofstream(folder) << "[general]\ndrivers = wave\n[wave]\nfile = /no/such/folder/out.wav\n";
    ::setenv("ALSOFT_CONF", folder.c_str(), 1);
    // In a process of its own: the library reads its configuration once.
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(std::exit(sound::Player::open(1.0f) == nullptr ? 0 : 1), ::testing::ExitedWithCode(0), "");
    std::filesystem::remove(folder);
}

}  // namespace
}  // namespace eti
