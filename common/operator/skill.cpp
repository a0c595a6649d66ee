// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/operator/skill.hpp"

#include <algorithm>
#include <cmath>

#include "common/math/random.hpp"

namespace eti {

namespace {

constexpr float clear_of_lips = 30e-3f;           // [m], of a tube between two attempts
constexpr float withdrawal_speed = 60e-3f;        // [m/s]
constexpr float slowest = 5e-3f, fastest = 0.3f;  // [m/s], of voluntary motion

Vec3f somewhere(Random& random, float spread) {
    const float x = random.normal(), y = random.normal(), z = random.normal();
    return spread * Vec3f(x, y, z);
}

/// Deviations that both hands share throughout an attempt.
void stray(Track& track, const Variation& by, float lack, bool tube, Random& random) {
    // One offset for all aims of a hand: a hand that misjudges the glottis to the left does so throughout.
    const Vec3f off = somewhere(random, lack * by.path);
    for (Stage& stage : track.stages) {
        if (!stage.keep) {
            stage.tip_fixed_offset += off + somewhere(random, 0.3f * lack * by.path);
        }
        const float pace = std::exp(lack * by.speed * (random.normal() - 1.0f));
        stage.speed =
            std::clamp(stage.speed * pace, std::min(slowest, stage.speed), std::max(fastest, stage.speed));
        stage.hold -= lack * by.pause * std::log(1.0f - random.uniform());
    }
    if (tube) {
        const float deeper = lack * by.depth * random.normal();
        track.steering = 1.0f - lack * by.steering * random.uniform();
        for (Stage& stage : track.stages) {
            if (stage.until_tube_depth >= 0.0f) {
                stage.until_tube_depth = std::max(0.0f, stage.until_tube_depth + deeper);
                stage.advance += std::max(0.0f, deeper);  // otherwise the path would end before
            }
        }
    } else {
        const float less = 1.0f - std::min(1.0f, lack * by.lift * std::abs(random.normal()));
        const float lever = lack * by.lever * std::abs(random.normal());
        for (Stage& stage : track.stages) {
            if (stage.keep && stage.lift > 0.0f) {
                stage.lift *= less;
                if (!stage.pivot_at_tip) {
                    stage.pitch += lever;
                }
            }
        }
    }
}

}  // namespace

std::vector<OperatorScript> make_attempts(const OperatorScript& script, std::uint64_t seed) {
    const float lack = 1.0f - script.skill;
    const Variation& by = script.variation;
    std::vector<OperatorScript> attempts(static_cast<std::size_t>(script.attempts), script);
    Random person(seed ^ 0x736b696c6cULL);  // independent of the tremor's course
    // Traits of a hand, the same in every attempt.
    const float tremor = lack * by.tremor * (0.5f + person.uniform());
    const float reaction = lack * by.reaction * (0.5f + person.uniform());
    const float satisfied = 1.0f - lack * by.view * person.uniform();  // share of the view that suffices
    for (std::size_t i = 0; i < attempts.size(); ++i) {
        OperatorScript& attempt = attempts[i];
        if (lack > 0.0f) {
            Random chance(person.bits());
            attempt.tremor += tremor;
            attempt.reaction += reaction;
            stray(attempt.laryngoscope, by, lack, false, chance);
            stray(attempt.tube, by, lack, true, chance);
            for (Track* track : {&attempt.laryngoscope, &attempt.tube}) {
                for (Stage& stage : track->stages) {
                    stage.until_view_percent *= stage.until_view_percent > 0.0f ? satisfied : 1.0f;
                }
            }
        }
        if (i > 0 && !attempt.tube.stages.empty()) {
            Stage back;
            back.name = "draw the tube back";
            back.keep = true;
            back.withdraw = clear_of_lips;
            back.speed = withdrawal_speed;
            attempt.tube.stages.insert(attempt.tube.stages.begin(), back);
        }
    }
    return attempts;
}

}  // namespace eti
