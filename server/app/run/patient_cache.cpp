// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/app/run/patient_cache.hpp"

#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

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

/// Creates the folder unless it exists. False if anyone else may write to it: models there are trusted.
bool is_own_folder(const std::filesystem::path& path) {
    (void)::mkdir(path.c_str(), S_IRWXU);
    struct stat status {};
    return ::lstat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == ::getuid() &&
           (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

}  // namespace

std::filesystem::path cache_folder() {
    namespace fs = std::filesystem;
    if (const char* own = std::getenv("ETI_CACHE"); own != nullptr && *own != '\0') {
        return own;
    }
    const char* const xdg = std::getenv("XDG_CACHE_HOME");
    const char* const home = std::getenv("HOME");
    const fs::path usual = xdg != nullptr && *xdg != '\0'
                               ? fs::path(xdg) / "neoeti"
                               : fs::path(home != nullptr ? home : "/tmp") / ".cache" / "neoeti";
    std::error_code error;
    fs::create_directories(usual, error);
    if (!error) {
        return usual;
    }
    const fs::path temporary =
        fs::temp_directory_path(error) / fmt::format("neoeti-{}", static_cast<unsigned>(::getuid()));
    return !error && is_own_folder(temporary) ? temporary : usual;
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
