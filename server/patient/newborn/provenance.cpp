// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include <fmt/format.h>

#include "common/math/units.hpp"
#include "server/patient/newborn/build/build.hpp"

namespace eti::patient {

Provenance provenance_of(const NewbornShape& shape, const BuildSettings& settings) {
    Provenance provenance = provenance_of(settings);
    provenance["generator"] = "implicit newborn";
    for (const ShapeField& field : shape_fields) {
        provenance[field.key()] = fmt::format("{}", shape.*field.value / field.per_unit);
    }
    provenance["modelled_jaw_opening_deg"] = fmt::format("{}", shape.jaw_opening / degree);
    return provenance;
}

Provenance provenance_of(const BuildSettings& settings) {
    return {{"epiglottis", settings.plate ? "plate" : "lattice"},
            {"version", ETI_VERSION},
            {"revision", ETI_ANATOMY_REVISION},  // hash of the sources that shape the model
            {"spacing_m", fmt::format("{}", settings.spacing)},
            {"fine_spacing_m", fmt::format("{}", settings.fine_spacing)},
            {"region_m", fmt::format("{}", settings.region)},
            {"tissue_stiffness_pa", fmt::format("{}", settings.tissue_stiffness)},
            {"surface_spacing_m", fmt::format("{}", settings.surface_spacing)},
            {"body_triangles", fmt::format("{}", settings.body_triangles)},
            {"shell_triangles", fmt::format("{}", settings.shell_triangles)}};
}

Provenance surface_provenance(Provenance provenance) {
    for (const char* const of_particles :
         {"spacing_m", "fine_spacing_m", "epiglottis", "region_m", "tissue_stiffness_pa"}) {
        provenance.erase(of_particles);
    }
    return provenance;
}

}  // namespace eti::patient
