// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/newborn/shape.hpp"

namespace eti::patient {

float duct(const Vec3f& p, std::span<const Station> stations) {
    float best = 1e9f;
    for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
        const Station& from = stations[i];
        const Station& to = stations[i + 1];
        const float along_a = to.anterior - from.anterior;
        const float along_s = to.superior - from.superior;
        const float squared = along_a * along_a + along_s * along_s;
        const float t = std::clamp(
            ((p.y() - from.anterior) * along_a + (p.z() - from.superior) * along_s) / squared, 0.0f, 1.0f);
        const float lateral = from.lateral + (to.lateral - from.lateral) * t;
        const float sagittal = from.sagittal + (to.sagittal - from.sagittal) * t;
        const float off_a = p.y() - from.anterior - along_a * t;
        const float off_s = p.z() - from.superior - along_s * t;
        const float radial = std::sqrt(p.x() * p.x() / (lateral * lateral) +
                                       (off_a * off_a + off_s * off_s) / (sagittal * sagittal));
        best = std::min(best, (radial - 1.0f) * std::min(lateral, sagittal));
    }
    return best;
}

}  // namespace eti::patient
