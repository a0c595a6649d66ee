// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/session_sound.hpp"

#include <spdlog/spdlog.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "client/hud/readout.hpp"

namespace eti::client {
namespace {

// Libraries below OpenAL print long warnings without an audio device, so without one they are not opened by
// default.
bool may_have_device() {
    const char* const runtime = std::getenv("XDG_RUNTIME_DIR");
    std::error_code error;
    return std::getenv("PULSE_SERVER") != nullptr || std::filesystem::exists("/dev/snd", error) ||
           (runtime != nullptr &&
            std::filesystem::exists(std::filesystem::path(runtime) / "pulse" / "native", error));
}

}  // namespace

sound::Cue cue_of(const view::SceneView& scene, bool server_lost) {
    const hud::Readout now = hud::make_readout(scene, server_lost);
    if (now.link != hud::ServerLink::running) {
        return {};
    }
    sound::Cue cue;
    if (now.vital_signs) {
        cue.pulse = {now.vital_signs->oxygen_saturation_percent, now.vital_signs->heart_rate_per_min};
    }
    cue.gum_pressed = hud::level_of(&LiveMeasures::gum_force_n, now.measures.gum_force_n) == hud::Level::bad;
    cue.suction = scene.live().suction > 0.5f;
    return cue;
}

std::unique_ptr<sound::Player> session_sound(std::optional<bool> wanted, float volume) {
    if (wanted == false || (!wanted && !may_have_device())) {
        return nullptr;
    }
    auto player = sound::Player::open(volume);
    if (!player && wanted == true) {
        spdlog::warn(
            "--sound on: no audio device found; the session is silent. Connect one and check that its sound "
            "server runs, or omit the option");
    }
    return player;
}

}  // namespace eti::client
