// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/metrics/airway_watch.hpp"

#include "common/model/thresholds.hpp"

namespace eti::metrics {

GateTracker::Change GateTracker::update(float past, bool in_reach, bool still_there, float slack) {
    if (!inside_ && past > slack && in_reach) {
        inside_ = true;
        return Change::in;
    }
    if (inside_ && (past < -slack || !still_there)) {
        inside_ = false;
        return Change::out;
    }
    return Change::none;
}

TubePlace AirwayWatch::place() const {
    return in_main_stem()    ? TubePlace::main_stem
           : in_trachea()    ? TubePlace::trachea
           : in_oesophagus() ? TubePlace::oesophagus
           : in_mouth()      ? TubePlace::mouth
                             : TubePlace::outside;
}

AirwayWatch::Changes AirwayWatch::update(const Vec3f& tip, const AirwayGates& places) {
    constexpr float slack = threshold::gate_slack.as_float();
    constexpr float carina_slack = threshold::carina_slack.as_float();
    const float to_trachea = places.from_trachea(tip);
    const float to_oesophagus = places.from_oesophagus(tip);
    // Below the carina neither line locates the tip: it stays in the passage that it entered above.
    const bool told_apart = places.along_trachea(tip) < places.trachea_length();
    const bool rather_trachea = to_trachea < to_oesophagus;
    Changes changes;
    changes.mouth =
        mouth_.update(places.mouth.past(tip),
                      places.mouth.radial_distance(tip) < threshold::mouth_radius.as_float(), true, slack);
    changes.trachea =
        trachea_.update(places.glottis.past(tip),
                        told_apart && to_trachea < threshold::glottis_radius.as_float() && rather_trachea,
                        !told_apart || to_trachea < to_oesophagus + slack, slack);
    changes.oesophagus = oesophagus_.update(
        places.oesophagus.past(tip),
        told_apart && to_oesophagus < threshold::oesophagus_radius.as_float() && !rather_trachea,
        !told_apart || to_oesophagus < to_trachea + slack, slack);
    past_glottis_ = trachea_.inside() ? places.along_trachea(tip) : -(tip - places.glottis.centre).norm();
    changes.main_stem = main_stem_.update(past_glottis_ - places.trachea_length(), trachea_.inside(),
                                          trachea_.inside(), carina_slack);
    return changes;
}

}  // namespace eti::metrics
