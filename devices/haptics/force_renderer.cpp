// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "devices/haptics/force_renderer.hpp"

#include <algorithm>

#include "common/model/pace.hpp"
#include "devices/haptics/gimbal_force.hpp"

namespace eti::devices {

namespace {

constexpr float never = -1.0f;  // an age that Freshness treats as stale

float age_of(std::int64_t arrived, std::int64_t now) {
    // A message may arrive after the start of the cycle.
    return arrived > 0 ? static_cast<float>(std::max(now - arrived, std::int64_t{0})) * 1e-9f : never;
}

Wrench scaled(const Wrench& wrench, float by) {
    return {by * wrench.force, by * wrench.torque};
}

}  // namespace

ForceRenderer::ForceRenderer(const RenderSettings& settings)
    : settings_(settings),
      freshness_(settings.safety),
      tissue_freshness_(settings.safety),
      recovery_ramp_(settings.safety),
      engagement_(settings.safety),
      passivity_(settings.passivity),
      speeds_(settings.prediction) {}

Wrench ForceRenderer::rigid_wrench(const Motion& device, const Motion& proxy) const {
    return settings_.tool == Tool::tube ? Wrench{} : coupling_wrench(device, proxy, settings_.coupling);
}

bool ForceRenderer::after_gap(const SceneState& scene) {
    const auto ns = [](float seconds) { return static_cast<std::int64_t>(1e9f * seconds); };
    // A force that has begun to fade must return by the ramp, too.
    const std::int64_t longest = ns(std::min(settings_.safety.gap, settings_.safety.stale_after()));
    const std::int64_t newest = std::max(scene.proxy_arrived, scene.tissue_arrived);
    const bool news = scene.proxy_arrived != proxy_arrived_ || scene.tissue_arrived != tissue_arrived_;
    if (scene.proxy_arrived - proxy_arrived_ > longest || scene.tissue_arrived - tissue_arrived_ > longest) {
        gap_ended_ = newest;
    }
    proxy_arrived_ = scene.proxy_arrived;
    tissue_arrived_ = scene.tissue_arrived;
    return news && newest - gap_ended_ <= ns(settings_.safety.settling_time);
}

Wrench ForceRenderer::soft_wrench(const SceneState& scene, const RigidTransform& proxy, float dt,
                                  bool after_gap) {
    Wrench now = scene.tissue.wrench;
    if (settings_.tool == Tool::laryngoscope) {
        now = settings_.soft_force == SoftForce::constraint
                  ? constraint_wrench(scene.tissue, proxy)
                  : displacement_wrench(scene.tissue.touching(), scene.blade, proxy, tissue_stiffness());
    }
    // After a gap, all added force returns by the slower ramp.
    const float due =
        after_gap ? 0.0f
                  : std::min(step_duration / std::max(scene.pace, settings_.prediction.min_real_time_factor),
                             0.02f);
    const Wrench smooth = soft_.update(now, scene.tissue_arrived, due, dt);
    // When the whole scene falls silent, fading the sum is enough; fading twice would be too steep.
    const float all = freshness_.share();
    const float share = all > 0.0f ? std::min(1.0f, tissue_freshness_.share() / all) : 0.0f;
    return scaled(smooth, settings_.coupling.tissue_gain * share);
}

Wrench ForceRenderer::for_device(const Wrench& shell, const Wrench& tissue, const Motion& device,
                                 const SceneState& scene) const {
    const Wrench sum{shell.force + tissue.force, shell.torque + tissue.torque};
    if (settings_.torque) {
        return sum;
    }
    // The contacts are the blade's.
    if (scene.proxy.contacts == 0 || settings_.tool == Tool::tube) {
        return {sum.force, Vec3f::Zero()};
    }
    return {gimbal_force(shell, tissue, device.pose.translation, scene.proxy.contact_centre,
                         device.pose * settings_.gimbal),
            Vec3f::Zero()};
}

Motion ForceRenderer::felt(const Motion& device) const {
    if (settings_.torque) {
        return device;
    }
    const Vec3f arm = device.pose.rotation * settings_.gimbal;
    return {{Quatf::Identity(), device.pose.translation + arm},
            device.velocity + device.angular_velocity.cross(arm),
            Vec3f::Zero()};
}

void ForceRenderer::release() {
    engagement_.disengage();
    recovery_ramp_.reset();
    last_ = {};
    passivity_.exerted({});
}

Wrench ForceRenderer::cycle(const Motion& device, const SceneState& scene, std::int64_t now, float dt) {
    const float age = age_of(scene.proxy_arrived, now);
    const bool touching = scene.proxy.contacts > 0 || scene.tissue.count > 0;
    const Speeds lately = speeds_.update(device, touching, dt);
    std::optional<Motion> proxy;
    if (age >= 0.0f) {
        proxy = settings_.tool == Tool::tube
                    ? device
                    : predicted_proxy(device, scene.proxy, age * scene.pace, scene.pace, settings_.prediction,
                                      lately, age > settings_.safety.gap);
    }
    // However late a cycle is, the force changes by no more than in a cycle on time.
    const float counted = std::min(dt, settings_.safety.longest_cycle);
    const float fresh_before = freshness_.share(), tissue_before = tissue_freshness_.share();
    const float fresh = freshness_.update(age);
    const float tissue_fresh = tissue_freshness_.update(age_of(scene.tissue_arrived, now));
    const bool returned = after_gap(scene);

    Wrench raw;
    if (proxy) {
        const Wrench rigid = rigid_wrench(device, *proxy);
        const Wrench soft = soft_wrench(scene, proxy->pose, dt, returned);
        const Wrench sum = for_device(rigid, soft, device, scene);
        if (!sum.is_finite()) {
            ++not_finite_;
            release();
            return {};
        }
        raw = clamp_to_limits(sum, settings_.coupling);
    }
    const bool served = dt <= settings_.safety.longest_pause;
    const float would_exert = std::max(raw.force.norm(), raw.torque.norm() / settings_.passivity.arm);
    const float share = engagement_.update(proxy.has_value() && served, would_exert, counted);
    const Wrench grown =
        recovery_ramp_.update(scaled(raw, share), last_, returned, counted, settings_.coupling);
    const bool steady =
        share >= 1.0f && fresh == fresh_before && tissue_fresh == tissue_before && !recovery_ramp_.active();
    const Wrench passive =
        clamp_to_limits(passivity_.apply(grown, felt(device), dt, steady), settings_.coupling);
    last_ = rate_limited(scaled(passive, fresh), last_, counted, settings_.coupling);
    if (fresh == 0.0f || share == 0.0f) {
        last_ = {};
    }
    passivity_.exerted(last_);
    return last_;
}

}  // namespace eti::devices
