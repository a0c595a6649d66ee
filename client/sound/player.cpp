// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/sound/player.hpp"

#include <AL/al.h>
#include <AL/alc.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include "client/sound/tones.hpp"
#include "common/process/threads/mailbox.hpp"

namespace eti::sound {
namespace {

constexpr auto period = std::chrono::milliseconds(5);

// 16-bit samples, which every device supports.
ALuint buffer_of(const std::vector<float>& samples) {
    std::vector<std::int16_t> numbers;
    numbers.reserve(samples.size());
    for (const float sample : samples) {
        numbers.push_back(static_cast<std::int16_t>(std::lround(32767.0f * sample)));
    }
    ALuint buffer = 0;
    alGenBuffers(1, &buffer);
    alBufferData(buffer, AL_FORMAT_MONO16, numbers.data(), static_cast<ALsizei>(2 * numbers.size()),
                 sample_rate);
    return buffer;
}

}  // namespace

struct Player::Impl {
    Impl(ALCdevice* opened, ALCcontext* made, float volume) : device(opened), context(made) {
        alListenerf(AL_GAIN, volume);
        alGenSources(static_cast<ALsizei>(sources.size()), sources.data());
        clicked = buffer_of(click());
        sucking = buffer_of(suction());
        alSourcei(sources[1], AL_BUFFER, static_cast<ALint>(clicked));
        alSourcei(sources[2], AL_BUFFER, static_cast<ALint>(sucking));
        alSourcei(sources[2], AL_LOOPING, AL_TRUE);
        alSourcef(sources[2], AL_GAIN, 0.0f);
        thread = std::thread([this] { run(); });
    }

    ~Impl() {
        ending = true;
        thread.join();
        alDeleteSources(static_cast<ALsizei>(sources.size()), sources.data());
        for (const auto& [pitch, buffer] : beeps) {
            alDeleteBuffers(1, &buffer);
        }
        alDeleteBuffers(1, &clicked);
        alDeleteBuffers(1, &sucking);
        alcMakeContextCurrent(nullptr);
        alcDestroyContext(context);
        alcCloseDevice(device);
    }

    void run() {
        auto last = std::chrono::steady_clock::now();
        while (!ending) {
            std::this_thread::sleep_for(period);
            const auto now = std::chrono::steady_clock::now();
            play(scheduler.advance(std::chrono::duration<double>(now - last).count(), cue.newest()));
            last = now;
        }
    }

    void play(const SoundEvents& now) {
        if (now.beep_hz) {
            // A tenth of a percent of saturation is 1.5 Hz, which is inaudible: whole hertz suffice.
            const long pitch = std::lround(*now.beep_hz);
            auto known = beeps.find(pitch);
            if (known == beeps.end()) {
                known = beeps.emplace(pitch, buffer_of(beep(static_cast<double>(pitch)))).first;
            }
            alSourceStop(sources[0]);
            alSourcei(sources[0], AL_BUFFER, static_cast<ALint>(known->second));
            alSourcePlay(sources[0]);
        }
        if (now.click) {
            alSourcePlay(sources[1]);
        }
        alSourcef(sources[2], AL_GAIN, now.suction);
        if (now.suction > 0.0f && !sucks) {
            alSourcePlay(sources[2]);
        } else if (now.suction == 0.0f && sucks) {
            alSourcePause(sources[2]);
        }
        sucks = now.suction > 0.0f;
    }

    ALCdevice* device;
    ALCcontext* context;
    std::array<ALuint, 3> sources{};  // beep, click, suction
    std::map<long, ALuint> beeps;     // by pitch [Hz]
    ALuint clicked = 0, sucking = 0;
    bool sucks = false;
    SoundScheduler scheduler;
    Mailbox<Cue> cue;
    std::atomic<bool> ending{false};
    std::thread thread;
};

Player::Player(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Player::~Player() = default;

std::unique_ptr<Player> Player::open(float volume) {
    ALCdevice* const device = alcOpenDevice(nullptr);
    if (device == nullptr) {
        return nullptr;
    }
    ALCcontext* const context = alcCreateContext(device, nullptr);
    if (context == nullptr || alcMakeContextCurrent(context) == ALC_FALSE) {
        if (context != nullptr) {
            alcDestroyContext(context);
        }
        alcCloseDevice(device);
        return nullptr;
    }
    return std::unique_ptr<Player>(new Player(std::make_unique<Impl>(device, context, volume)));
}

void Player::set_cue(const Cue& cue) {
    impl_->cue.write(cue);
}

}  // namespace eti::sound
