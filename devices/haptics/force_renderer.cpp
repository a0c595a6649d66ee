// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/force_renderer.hpp"

#include <algorithm>

namespace eti::devices {

namespace {

constexpr float never = -1.0f;  // an age that Freshness takes for stale

float age_of(std::int64_t arrived, std::int64_t now) {
    return arrived > 0 ? static_cast<float>(now - arrived) * 1e-9f : never;
}

Wrench scaled(const Wrench& wrench, float by) {
    return {by * wrench.force, by * wrench.torque};
}

}  // namespace

ForceRenderer::ForceRenderer(const RenderSettings& settings)
    : settings_(settings),
      freshness_(settings.safety),
      tissue_freshness_(settings.safety),
      engagement_(settings.safety) {}

Wrench ForceRenderer::soft_wrench(const SceneState& scene, const RigidTransform& proxy) const {
    // When the whole scene falls silent the fade of the sum below is enough; twice would be too steep.
    const float all = freshness_.share();
    const float share = all > 0.0f ? std::min(1.0f, tissue_freshness_.share() / all) : 0.0f;
    const float gain = settings_.coupling.tissue_gain * share;
    return scaled(settings_.soft_force == SoftForce::constraint
                      ? scene.tissue.wrench
                      : displacement_wrench(scene.tissue.touching(), scene.blade, proxy, tissue_stiffness()),
                  gain);
}

Wrench ForceRenderer::cycle(const Motion& device, const SceneState& scene, std::int64_t now, float dt) {
    const float age = age_of(scene.proxy_arrived, now);
    const std::optional<Motion> proxy =
        age >= 0.0f ? predicted_proxy(device, scene.proxy, age * scene.pace, scene.pace, settings_.prediction)
                    : std::nullopt;
    const float fresh = freshness_.update(proxy ? age : never, dt);
    tissue_freshness_.update(age_of(scene.tissue_arrived, now), dt);

    Wrench raw;
    if (proxy) {
        const Wrench rigid = coupling_wrench(device, *proxy, settings_.coupling);
        const Wrench soft = soft_wrench(scene, proxy->pose);
        const Wrench sum{rigid.force + soft.force, rigid.torque + soft.torque};
        if (!sum.force.allFinite() || !sum.torque.allFinite()) {
            ++not_finite_;
            engagement_.disengage();
            last_ = {};
            return {};
        }
        raw = limited(sum, settings_.coupling);
    } else {
        raw = last_;  // fades from what was felt last
    }
    const float share = engagement_.update(fresh > 0.0f, raw.force.norm(), dt);
    last_ = rate_limited(proxy ? scaled(raw, share) : raw, last_, dt, settings_.coupling);
    if (fresh == 0.0f) {
        last_ = {};
    }
    return scaled(last_, fresh);
}

}  // namespace eti::devices
