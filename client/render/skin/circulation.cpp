// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/skin/circulation.hpp"

#include <cmath>

#include "common/math/smoothstep.hpp"

namespace eti::render {
namespace {

constexpr double healthy_saturation = 100.0, healthy_heart_rate = 140.0;
// [s], time constant of hands and feet; chosen: a few times the 2 to 3 s of a newborn's capillary refill.
constexpr double peripheral_delay = 10.0;
// [%], more oxygen is extracted where blood flows slowly. Chosen; a saturation of 95 % leaves hands pink.
constexpr double peripheral_extraction = 4.0;
// [1/min]: resuscitation starts ventilation below 100 and compressions below 60.
constexpr float pale_from = 100.0f, palest_at = 60.0f;

}  // namespace

float cyanosis(double saturation_percent) {
    return smoothstep(90.0f, 60.0f, static_cast<float>(saturation_percent));
}

void Circulation::update(double time_s, std::optional<double> saturation_percent,
                         std::optional<double> heart_rate_per_min) {
    central_ = saturation_percent.value_or(healthy_saturation);
    heart_rate_ = heart_rate_per_min.value_or(healthy_heart_rate);
    if (!saturation_percent || !time_s_ || time_s < *time_s_) {
        peripheral_ = central_;
    } else {
        peripheral_ += (1.0 - std::exp(-(time_s - *time_s_) / peripheral_delay)) * (central_ - peripheral_);
    }
    time_s_ = saturation_percent ? std::optional(time_s) : std::nullopt;
}

Vec3f Circulation::colouring() const {
    return {cyanosis(central_), cyanosis(peripheral_ - peripheral_extraction),
            smoothstep(pale_from, palest_at, static_cast<float>(heart_rate_))};
}

}  // namespace eti::render
