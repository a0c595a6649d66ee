// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/patient_cache.hpp"

#include <spdlog/spdlog.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "common/math/hash.hpp"
#include "server/patient/model/model_file.hpp"
#include "server/patient/model/stiffness.hpp"

namespace eti::app {

namespace {

std::uint64_t hash_of(const patient::Provenance& provenance) {
    Hash hash;
    for (const auto& [key, value] : provenance) {
        hash.add(key + "=" + value + "\n");
    }
    return hash.value();
}

}  // namespace

std::filesystem::path cache_folder() {
    if (const char* own = std::getenv("ETI_CACHE"); own != nullptr && *own != '\0') {
        return own;
    }
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg != '\0') {
        return std::filesystem::path(xdg) / "neoeti";
    }
    const char* home = std::getenv("HOME");
    return std::filesystem::path(home != nullptr ? home : "/tmp") / ".cache" / "neoeti";
}

namespace {

/// A cached model with the surfaces and shell of `provenance`, whatever its particles.
std::optional<patient::Patient> find_with_same_surfaces(const patient::Provenance& provenance,
                                                        const std::string& name) {
    std::error_code error;
    for (std::filesystem::directory_iterator i(cache_folder(), error), end; !error && i != end;
         i.increment(error)) {
        try {
            if (i->path().filename().string().starts_with(name) &&
                patient::surface_provenance(patient::load_provenance(i->path())) ==
                    patient::surface_provenance(provenance)) {
                return patient::load_patient(i->path());
            }
        } catch (const std::exception&) {
            continue;  // another may be intact; if not, everything is built
        }
    }
    return std::nullopt;
}

/// With the stiffness of `settings`.
patient::Patient patient_in_cache(const NewbornShape& shape, const patient::BuildSettings& settings) {
    const patient::Provenance provenance = patient::provenance_of(shape, settings);
    const std::string form =
        fmt::format("newborn-{:016x}-", hash_of(patient::surface_provenance(provenance)));
    const std::filesystem::path file =
        cache_folder() / fmt::format("{}{:016x}.h5", form, hash_of(provenance));
    std::error_code error;
    if (std::filesystem::exists(file, error)) {
        try {
            if (patient::load_provenance(file) == provenance) {
                return patient::load_patient(file);
            }
        } catch (const std::exception& e) {
            spdlog::warn("cannot use the cached model, rebuilding it: {}", e.what());
        }
    }
    const std::optional<patient::Patient> surface_source = find_with_same_surfaces(provenance, form);
    spdlog::info("building {}; it is cached as {}",
                 surface_source ? "particles for a patient whose surfaces are cached" : "the patient model",
                 file.string());
    patient::Patient patient =
        patient::build_patient(shape, settings, surface_source ? &*surface_source : nullptr);
    try {
        std::filesystem::create_directories(file.parent_path());
        patient::save_patient(patient, file, provenance);
    } catch (const std::exception& e) {
        spdlog::warn("model not cached ({}); the next start rebuilds it. Set ETI_CACHE to a writable folder.",
                     e.what());
    }
    return patient;
}

}  // namespace

patient::Patient cached_patient(const NewbornShape& shape, patient::BuildSettings settings) {
    // Geometry does not depend on stiffness: one cached model serves all.
    const float stiffness =
        std::exchange(settings.tissue_stiffness, patient::BuildSettings{}.tissue_stiffness);
    patient::Patient patient = patient_in_cache(shape, settings);
    patient::set_tissue_stiffness(patient, stiffness);
    return patient;
}

}  // namespace eti::app
